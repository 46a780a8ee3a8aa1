// SPDX-License-Identifier: Apache-2.0
// How functions on lanes are compiled: into their caller, and for a GPU as well where its compiler reads them.
#pragma once

#ifdef __CUDACC__
#define SLIPWISE_LANES __host__ __device__ __forceinline__
#define SLIPWISE_LANES_APART __host__ __device__ __forceinline__
#else
#define SLIPWISE_LANES [[gnu::always_inline]] inline
#define SLIPWISE_LANES_APART [[gnu::noinline]]  // too long, or too rarely used, to stand in every caller
#endif
