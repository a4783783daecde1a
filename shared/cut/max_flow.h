// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Boykov and Kolmogorov's max-flow (libmaxflow), with the capacities that the
// cuts here need: 32-bit edges, 64-bit terminals and total.
#define MAXFLOW_INCLUDE_TEMPLATE_IMPLEMENTATION
#ifdef __GNUC__  // GCC 13 and later doubt how the library moves its arrays
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpragmas"
#pragma GCC diagnostic ignored "-Wuse-after-free"
#endif
#include <maxflow.h>
#ifdef __GNUC__
#pragma GCC diagnostic pop
#endif

#include <cstdint>
#include <new>

namespace parts::cut {

/// Throws std::bad_alloc where the library would end the program.
struct FlowGraph : maxflow::Graph<int, std::int64_t, std::int64_t> {
  FlowGraph(int nodes, int edges) : Graph(nodes, edges, [](const char*) { throw std::bad_alloc(); }) {}
};
/// The same for edges whose capacities are measured rather than counted.
struct WideFlowGraph : maxflow::Graph<std::int64_t, std::int64_t, std::int64_t> {
  WideFlowGraph(int nodes, int edges) : Graph(nodes, edges, [](const char*) { throw std::bad_alloc(); }) {}
};
constexpr std::int64_t kUncuttableTerminal = std::int64_t(1) << 60;
constexpr int kUncuttable = 1 << 30;

}  // namespace parts::cut
