// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

namespace parts {

/// How many threads an option asks for: itself, or one a core for 0 and less.
int thread_count(int asked);

/// Calls body(begin, end) for pieces that cover [0, n) once, on up to as many
/// threads as thread_count(threads) says, the calling one among them. What the
/// body computes must not depend on where the pieces are cut. Calls may nest.
/// When bodies throw, what is thrown again here is the exception of the lowest
/// index, whatever the threads; all pieces before it have been called.
void parallel_for(long n, int threads, const std::function<void(long begin, long end)>& body);

}  // namespace parts
