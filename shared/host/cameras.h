// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "host_api.h"
#include "parts/host/filter.h"

namespace parts::host {

/// The host's form of a camera. @param distance  see to_mlp()
Shotm to_shot(const render::Camera& camera, double distance);

/// Nothing where the shot has never been set, or no image of square pixels.
std::optional<render::Camera> to_camera(const Shotm& shot);

/// Gives a layer the camera through which it was seen.
void set_camera(const render::Camera& camera, MeshModel& layer);

/// Fills a new raster layer.
void write_raster(const Outcome::NewRaster& raster, RasterModel& layer);

}  // namespace parts::host
