// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/examples/class_models.h"

namespace parts::colorize {

/// The pixels of views in which a mesh shows faces whose colours stay. @return 8U each
std::vector<cv::Mat> kept_pixels(const examples::ClassModel& mesh, const std::vector<char>& kept_faces,
                                 const std::vector<examples::Example>& views);

/// What to add to the colours that were found for vertices so that they go with
/// those that stay: what these differ by, where found colour and place are most
/// alike, so that a shirt takes the change of the shirt and skin that of skin.
/// @param vertices  in a frame in which the mesh is about 1 large
/// @param found     Y, Cb and Cr of every vertex, 0..1
/// @param own       the same of those that stay
/// @param kept      per vertex: it stays
std::vector<Eigen::Vector3f> corrections(const std::vector<Vec3>& vertices, const std::vector<Eigen::Vector3f>& found,
                                         const std::vector<Eigen::Vector3f>& own, const std::vector<char>& kept,
                                         int threads);

}  // namespace parts::colorize
