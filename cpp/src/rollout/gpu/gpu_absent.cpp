// SPDX-License-Identifier: Apache-2.0
// What stands in for a GPU where the library was built without one: the reason, and nothing that can be called.
#include <stdexcept>

#include "slipwise/rollout/gpu/gpu_device.hpp"

namespace slipwise {
namespace {

[[noreturn]] void refuse() { throw std::logic_error(why_no_gpu()); }

}  // namespace

std::string why_no_gpu() {  // NOLINT(modernize-use-string-view): with CUDA it is composed
  return "this slipwise was built without CUDA; build it with -DSLIPWISE_CUDA=ON, or roll out on the processor";
}

void* gpu_allocate(std::size_t /*bytes*/) { refuse(); }
void gpu_free(void* /*memory*/) noexcept {}
bool lies_on_gpu(const void* /*pointer*/) { return false; }
void gpu_copy(const GpuCopy& /*copy*/) { refuse(); }
unsigned gpu_roll(const ThreadJob<float>& /*job*/, bool /*wide*/, unsigned* /*faults*/) { refuse(); }
unsigned gpu_roll(const ThreadJob<double>& /*job*/, bool /*wide*/, unsigned* /*faults*/) { refuse(); }

}  // namespace slipwise
