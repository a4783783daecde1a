// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "parts/mesh/mesh.h"

/// A class of shapes of the project's own: stylised human busts, for tests and
/// demonstrations of what needs a database of similar models.
namespace parts::test {

/// A bust, feature by feature. It stands along y and faces +z; the head is about
/// 1 high, its centre near the origin. Lengths in that unit, colours RGB.
struct BustShape {
  double head_width = 0.36, head_length = 0.45, head_height = 0.42;  ///< half axes of the skull
  double jaw_width = 0.27, jaw_drop = 0.2, chin = 0.1, chin_forward = 0.3;
  double cheek = 0.1, cheek_height = -0.06;
  double brow = 0.045, brow_height = 0.135;
  double eye_distance = 0.145, eye_size = 0.074, eye_depth = 0.06;
  double nose_length = 0.185, nose_forward = 0.115, nose_width = 0.06, nose_tip = 0.045, nose_bridge = 0.034;
  double nose_tip_drop = 0.0;  ///< the tip below (+) or above the nostrils
  double mouth_width = 0.1, lip = 0.026, mouth_height = -0.25;
  double ear_size = 0.12, ear_out = 0.4;  ///< half height; how far they stand off, radians
  double neck = 0.19, shoulder_width = 0.5, shoulder_drop = 0.1;
  Eigen::Vector3d skin{226, 180, 152}, hair{70, 48, 34}, lips{186, 96, 92}, iris{70, 96, 120}, shirt{96, 110, 140};
  double hair_line = 0.25;  ///< height of it above the brow
  unsigned seed = 0;        ///< of the texture's grain
};

/// Another person for another seed; the same on every machine.
BustShape random_bust(unsigned seed);

/// Closed, oriented outwards, 8,000 to 12,000 faces at the default resolution,
/// with texture coordinates of one texture.
/// @param texture  the name of its image file, as Mesh::textures
Mesh bust_mesh(const BustShape& shape, const std::string& texture = "", int cells = 64);

/// The image for bust_mesh's texture coordinates, RGB (OpenCV's BGR order), size x size.
cv::Mat bust_texture(const BustShape& shape, const Mesh& mesh, int size = 512);

/// Places that the shape knows exactly.
struct BustLandmarks {
  Vec3 nose_tip, crown, chin;
};
BustLandmarks bust_landmarks(const BustShape& shape);

/// Damages a bust for tests of its repair. @param faces  a flag a face of the
/// damaged mesh: 1 = damaged
Mesh without_ball(const Mesh& mesh, const Vec3& center, double radius);
Mesh gouged(const Mesh& mesh, const Vec3& center, double radius, double depth, unsigned seed,
            std::vector<char>* faces = nullptr);

}  // namespace parts::test
