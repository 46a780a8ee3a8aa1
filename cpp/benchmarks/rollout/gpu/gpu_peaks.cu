// SPDX-License-Identifier: Apache-2.0
// Measures the peaks with CUDA's own clock, best of several runs.
#include "gpu_peaks.hpp"

#include <cuda_runtime.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace slipwise::benchmarks {
namespace {

constexpr int kRuns = 20;
constexpr int kRounds = 4096;
constexpr int kChains = 8;
constexpr int kThreads = 256;

void check(cudaError_t error) {
  if (error != cudaSuccess) {
    throw std::runtime_error(std::string("the GPU failed: ") + cudaGetErrorString(error));
  }
}

/// Shortest time of several runs [s].
template <typename Work>
double best_seconds(const Work& work) {
  cudaEvent_t start{};
  cudaEvent_t end{};
  check(cudaEventCreate(&start));
  check(cudaEventCreate(&end));
  float best = std::numeric_limits<float>::infinity();
  for (int i = 0; i < kRuns; ++i) {
    check(cudaEventRecord(start));
    work();
    check(cudaEventRecord(end));
    check(cudaEventSynchronize(end));
    float milliseconds = 0.0F;
    check(cudaEventElapsedTime(&milliseconds, start, end));
    best = std::min(best, milliseconds);
  }
  check(cudaEventDestroy(start));
  check(cudaEventDestroy(end));
  return 1e-3 * best;
}

__global__ void multiply_and_add(float factor, float summand, float* sink) {
  float actuator[kChains];
  for (int c = 0; c < kChains; ++c) {
    actuator[c] = static_cast<float>(threadIdx.x + c);
  }
  for (int i = 0; i < kRounds; ++i) {
#pragma unroll
    for (int c = 0; c < kChains; ++c) {
      actuator[c] = fmaf(actuator[c], factor, summand);
    }
  }
  float sum = 0.0F;
  for (const float number : actuator) {
    sum += number;
  }
  if (sum == 1.0F) {  // it is not, which the compiler does not know
    *sink = sum;
  }
}

cudaDeviceProp properties() {
  int device = 0;
  check(cudaGetDevice(&device));
  cudaDeviceProp found{};
  check(cudaGetDeviceProperties(&found, device));
  return found;
}

}  // namespace

std::string gpu_name() {
  const cudaDeviceProp card = properties();
  return std::string(card.name) + ", sm_" + std::to_string(card.major) + std::to_string(card.minor) + ", " +
         std::to_string(card.multiProcessorCount) + " multiprocessors";
}

double copy_bandwidth() {
  constexpr std::size_t kBytes = std::size_t{256} << 20U;
  void* from = nullptr;
  void* to = nullptr;
  check(cudaMalloc(&from, kBytes));
  check(cudaMalloc(&to, kBytes));
  check(cudaMemset(from, 0, kBytes));
  const double seconds = best_seconds([&] { check(cudaMemcpyAsync(to, from, kBytes, cudaMemcpyDeviceToDevice)); });
  check(cudaFree(from));
  check(cudaFree(to));
  return 2.0 * kBytes / seconds;
}

double multiply_adds() {
  const int blocks = 16 * properties().multiProcessorCount;
  float* sink = nullptr;
  check(cudaMalloc(&sink, sizeof(float)));
  const double seconds = best_seconds([&] { multiply_and_add<<<blocks, kThreads>>>(0.999F, 0.1F, sink); });
  check(cudaGetLastError());
  check(cudaFree(sink));
  return static_cast<double>(blocks) * kThreads * kRounds * kChains / seconds;
}

}  // namespace slipwise::benchmarks
