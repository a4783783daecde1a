// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/io/mlp_project.h"
#include "parts/render/camera.h"

namespace parts::render {

/// A camera as projects have it. Orthographic ones (CameraType 1) keep world
/// units a pixel as their pixel size; MeshLab shows both through its focal
/// length, which is given for an object at `distance`.
io::MlpCamera to_mlp(const Camera& camera, double distance);

/// @throws UserError  no camera is given, or no pixel size, viewport or focal length
Camera from_mlp(const io::MlpCamera& camera, const std::string& label);

}  // namespace parts::render
