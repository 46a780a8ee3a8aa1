// SPDX-License-Identifier: Apache-2.0
// A GPU made of the processor's own memory, on which the very kernel runs, thread after thread: what can be tested
// without a card. Everything but CUDA's own calls is the library's.
#include <cstddef>
#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>

#include "slipwise/rollout/gpu/gpu_device.hpp"

namespace slipwise {
namespace {

struct Piece {
  std::unique_ptr<std::byte[]> bytes;  // NOLINT(modernize-avoid-c-arrays)
  std::size_t size;
};

std::map<const std::byte*, Piece, std::greater<>>& pieces() {
  static std::map<const std::byte*, Piece, std::greater<>> all;
  return all;
}

template <typename Scalar>
struct RunHere {
  const ThreadJob<Scalar>& job;
  unsigned* faults;

  template <Actuator kActuator, Slip kSlip, bool kWide>
  void call() const {
    for (std::size_t rollout = 0; rollout < job.job.rollouts; ++rollout) {
      *faults |= roll_thread<kActuator, kSlip, kWide>(job, rollout);
    }
  }
};

void check_pointer(const void* pointer) {
  if (pointer != nullptr && !lies_on_gpu(pointer)) {
    throw std::logic_error("the kernel was given a pointer of the processor's memory");
  }
}

template <typename Scalar>
unsigned roll_all(const ThreadJob<Scalar>& job, bool wide, unsigned* faults) {
  for (const void* pointer :
       {static_cast<const void*>(job.job.v), static_cast<const void*>(job.job.omega),
        static_cast<const void*>(job.starts), static_cast<const void*>(job.past), static_cast<const void*>(faults),
        static_cast<const void*>(job.job.path[0]), static_cast<const void*>(job.job.path[1]),
        static_cast<const void*>(job.job.path[2]), static_cast<const void*>(job.job.end[0]),
        static_cast<const void*>(job.job.end[1]), static_cast<const void*>(job.job.end[2]),
        static_cast<const void*>(job.job.map.cells), static_cast<const void*>(job.job.cost_sum),
        static_cast<const void*>(job.job.cost_highest), static_cast<const void*>(job.job.cost_lowest)}) {
    check_pointer(pointer);
  }
  *faults = kNoFault;
  with_thread_kernel(job.job, wide, RunHere<Scalar>{job, faults});
  return *faults;
}

}  // namespace

std::string why_no_gpu() { return ""; }

void* gpu_allocate(std::size_t bytes) {
  auto memory = std::make_unique<std::byte[]>(bytes);  // NOLINT(modernize-avoid-c-arrays)
  std::byte* at = memory.get();
  pieces().emplace(at, Piece{std::move(memory), bytes});
  return at;
}

void gpu_free(void* memory) noexcept { pieces().erase(static_cast<const std::byte*>(memory)); }

bool lies_on_gpu(const void* pointer) {
  const auto* at = static_cast<const std::byte*>(pointer);
  const auto found = pieces().lower_bound(at);  // the last piece that begins before it
  return found != pieces().end() && std::less<>{}(at, found->first + found->second.size);
}

void gpu_copy(const GpuCopy& copy) {
  for (std::size_t row = 0; row < copy.rows; ++row) {
    std::memcpy(static_cast<std::byte*>(copy.to) + row * copy.to_pitch,
                static_cast<const std::byte*>(copy.from) + row * copy.from_pitch, copy.width);
  }
}

unsigned gpu_roll(const ThreadJob<float>& job, bool wide, unsigned* faults) { return roll_all(job, wide, faults); }
unsigned gpu_roll(const ThreadJob<double>& job, bool wide, unsigned* faults) { return roll_all(job, wide, faults); }

}  // namespace slipwise
