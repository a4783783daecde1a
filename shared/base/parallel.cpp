// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/base/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <limits>
#include <mutex>
#include <thread>

#include "parts/base/arena.h"

namespace parts {
namespace {

/// The exception of the lowest index, of pieces that run in any order.
class FirstFailure {
 public:
  /// Whether a piece that begins at this index can be left out.
  bool before(long begin) const { return lowest_ < begin; }
  void keep(long begin) {
    const std::lock_guard lock(mutex_);
    if (lowest_ <= begin) return;
    lowest_ = begin;
    error_ = std::current_exception();
  }
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  std::atomic<long> lowest_{std::numeric_limits<long>::max()};
  std::mutex mutex_;
  std::exception_ptr error_;
};

}  // namespace

int thread_count(int asked) { return asked > 0 ? asked : std::max(1, int(std::thread::hardware_concurrency())); }

void parallel_for(long n, int threads, const std::function<void(long, long)>& body) {
  const long most = std::min<long>(thread_count(threads), n);
  if (most <= 1) {
    if (n > 0) body(0, n);
    return;
  }
  FirstFailure failure;
  const auto piece = [&](const tbb::blocked_range<long>& range) {
    take_over();
    if (!failure.before(range.begin())) try {
        body(range.begin(), range.end());
      } catch (...) {
        failure.keep(range.begin());
      }
    hand_over();
  };
  // Some pieces a thread even out what they take; each piece may set up something of its own.
  const long grain = std::max(1L, n / (8 * most));
  in_arena(int(most), [&] {
    hand_over();
    tbb::parallel_for(tbb::blocked_range<long>(0, n, grain), piece, tbb::simple_partitioner());
    take_over();
  });
  failure.rethrow();
}

}  // namespace parts
