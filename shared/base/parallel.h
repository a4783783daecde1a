// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <exception>
#include <system_error>
#include <thread>
#include <vector>

namespace parts {

inline int thread_count(int asked) { return asked > 0 ? asked : std::max(1, int(std::thread::hardware_concurrency())); }

/// Calls body(begin, end) over [0, n) cut into one contiguous band a thread.
/// What the bands compute must not depend on where they are cut. An exception
/// of a band is thrown again here, the first band's first.
template <class Body>
void parallel_for(long n, int threads, const Body& body) {
  const long bands = std::min<long>(thread_count(threads), n);
  if (bands <= 1) {
    if (n > 0) body(0L, n);
    return;
  }
  std::vector<std::exception_ptr> failed(bands);
  std::vector<std::thread> pool;
  pool.reserve(bands - 1);
  const auto run = [&](long t) {
    try {
      body(n * t / bands, n * (t + 1) / bands);
    } catch (...) {
      failed[t] = std::current_exception();
    }
  };
  for (long t = 1; t < bands; ++t) try {
      pool.emplace_back(run, t);
    } catch (const std::system_error&) {
      run(t);  // no more threads to be had
    }
  run(0);
  for (std::thread& t : pool) t.join();
  for (const std::exception_ptr& e : failed)
    if (e) std::rethrow_exception(e);
}

}  // namespace parts
