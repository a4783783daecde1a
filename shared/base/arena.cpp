// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/base/arena.h"

#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <stdexcept>

namespace parts {
namespace {

/// libtbb makes its threads when they are first asked for. Where the system has
/// none to give, that one call throws and later ones do with the threads that
/// there are; so the first call is one that has nothing to lose.
bool start_threads(int cores) {
  try {
    tbb::task_arena(cores).execute([&] {
      tbb::parallel_for(
          0, 4 * cores, [](int) {}, tbb::simple_partitioner());
    });
    return true;
  } catch (const std::runtime_error&) {
    return false;
  }
}

std::atomic<unsigned> handed_over{0};

}  // namespace

void hand_over() { handed_over.fetch_add(1, std::memory_order_acq_rel); }
void take_over() { handed_over.load(std::memory_order_acquire); }

void in_arena(int threads, const std::function<void()>& work) {
  static const int cores = tbb::info::default_concurrency();
  static const bool started = start_threads(cores);
  static_cast<void>(started);
  tbb::task_arena(std::clamp(threads, 1, cores)).execute(work);
}

}  // namespace parts
