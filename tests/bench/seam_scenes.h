// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "bench/scenes.h"
#include "parts/compose/deform.h"

namespace parts::bench {

/// Compositions of models from Debian's libcgal-demo, of the optional models
/// and of shapes of our own: those of the demos, and others.
std::vector<Scene> seam_scenes();

/// A model and how a part of it is bent.
struct Bend {
  std::string name;
  Mesh mesh;
  std::vector<char> fixed, moving;
  compose::RigidPose pose;
};
std::vector<Bend> bends();

/// A mesh of libcgal-demo, unpacked where it is not yet.
Mesh cgal_mesh(const std::string& file);

}  // namespace parts::bench
