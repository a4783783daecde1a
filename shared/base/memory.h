// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace parts {

/// Bytes that this process may still use without swapping; 0 if not known.
double available_memory();

}  // namespace parts
