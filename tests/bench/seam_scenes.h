// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "bench/scenes.h"

namespace parts::bench {

/// Compositions of models from Debian's libcgal-demo, of the optional models
/// and of shapes of our own: those of the demos, and others.
std::vector<Scene> seam_scenes();

/// A mesh of libcgal-demo, unpacked where it is not yet.
Mesh cgal_mesh(const std::string& file);

/// The faces with a corner in a box.
std::vector<char> faces_in(const Mesh& mesh, const Box& box);

}  // namespace parts::bench
