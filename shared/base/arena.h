// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

namespace parts {

/// Calls work() on this thread, in a TBB arena of its own with room for up to
/// `threads` threads: who waits in it takes up no other work meanwhile. Never
/// more threads than cores.
void in_arena(int threads, const std::function<void()>& work);

/// What one thread has written before hand_over() is seen by another after its
/// take_over(). TBB does this too, but ThreadSanitizer does not see into it.
void hand_over();
void take_over();

}  // namespace parts
