// SPDX-License-Identifier: Apache-2.0
// CUDA: memory, copies, and the kernel, in which one thread drives one rollout.
#include "slipwise/rollout/gpu/gpu_device.hpp"

#include <cuda_runtime.h>

#include <stdexcept>

namespace slipwise {
namespace {

constexpr unsigned kThreads = 64;  // of a block: small, so that a few thousand rollouts use the whole card

void check(cudaError_t error, const char* doing) {
  if (error != cudaSuccess) {
    cudaGetLastError();  // it was reported; the next call is not to see it again
    throw std::runtime_error(std::string("the GPU failed while ") + doing + ": " + cudaGetErrorString(error));
  }
}

template <typename Scalar, Actuator kActuator, Slip kSlip, bool kWide>
__global__ void __launch_bounds__(kThreads) roll(const __grid_constant__ ThreadJob<Scalar> job, unsigned* faults) {
  const std::size_t rollout = static_cast<std::size_t>(blockIdx.x) * kThreads + threadIdx.x;
  if (rollout >= job.job.rollouts) {
    return;
  }
  const unsigned found = roll_thread<kActuator, kSlip, kWide>(job, rollout);
  if (found != kNoFault) {
    atomicOr(faults, found);
  }
}

/// Starts the kernel that is made for a job.
template <typename Scalar>
struct Launch {
  const ThreadJob<Scalar>& job;
  unsigned* faults;

  template <Actuator kActuator, Slip kSlip, bool kWide>
  void call() const {
    const auto blocks = static_cast<unsigned>((job.job.rollouts + kThreads - 1) / kThreads);
    roll<Scalar, kActuator, kSlip, kWide><<<blocks, kThreads>>>(job, faults);
  }
};

template <typename Scalar>
unsigned roll_all(const ThreadJob<Scalar>& job, bool wide, unsigned* faults) {
  unsigned found = kNoFault;
  check(cudaMemset(faults, 0, sizeof(found)), "clearing its memory");
  with_thread_kernel(job.job, wide, Launch<Scalar>{job, faults});
  check(cudaGetLastError(), "starting the rollouts");
  check(cudaMemcpy(&found, faults, sizeof(found), cudaMemcpyDeviceToHost), "driving the rollouts");
  return found;
}

}  // namespace

std::string why_no_gpu() {
  int count = 0;
  const cudaError_t error = cudaGetDeviceCount(&count);
  cudaGetLastError();
  if (error == cudaSuccess && count > 0) {
    return "";
  }
  return std::string("there is no GPU that CUDA can use here (") +
         (error == cudaSuccess ? "none was found" : cudaGetErrorString(error)) +
         "); check that nvidia-smi shows one and that its driver is new enough, or roll out on the processor";
}

void* gpu_allocate(std::size_t bytes) {
  void* memory = nullptr;
  check(cudaMalloc(&memory, bytes), "giving memory");
  return memory;
}

void gpu_free(void* memory) noexcept {
  if (memory != nullptr) {
    cudaFree(memory);
  }
}

bool lies_on_gpu(const void* pointer) {
  cudaPointerAttributes attributes{};
  check(cudaPointerGetAttributes(&attributes, pointer), "looking up a pointer");
  return attributes.type == cudaMemoryTypeDevice || attributes.type == cudaMemoryTypeManaged;
}

void gpu_copy(const GpuCopy& copy) {
  const bool in_one_piece = copy.rows == 1 || (copy.to_pitch == copy.width && copy.from_pitch == copy.width);
  check(in_one_piece ? cudaMemcpy(copy.to, copy.from, copy.width * copy.rows, cudaMemcpyDefault)  // of any size
                     : cudaMemcpy2D(copy.to, copy.to_pitch, copy.from, copy.from_pitch, copy.width, copy.rows,
                                    cudaMemcpyDefault),
        "copying");
}

unsigned gpu_roll(const ThreadJob<float>& job, bool wide, unsigned* faults) { return roll_all(job, wide, faults); }
unsigned gpu_roll(const ThreadJob<double>& job, bool wide, unsigned* faults) { return roll_all(job, wide, faults); }

}  // namespace slipwise
