// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/mesh/mesh.h"

class MeshModel;

namespace parts::host {

/// A layer as a mesh in world space: its matrix is applied to positions and
/// normals, a mirroring one flips the faces; coordinates are copied exactly
/// where it is the identity. Deleted elements are skipped, attributes come along
/// where the layer has them, texture files get absolute names. A point cloud or
/// an empty layer gives a mesh without faces.
Mesh read_layer(const MeshModel& layer);

/// The bounding box of read_layer(), cheaply; empty where no vertex is finite.
Box layer_box(const MeshModel& layer);

/// How far apart the coordinates that the host can keep lie where the layer's
/// surface is: most hosts have them in single precision. World units.
double coordinate_step(const MeshModel& layer);

/// Fills an empty layer: elements, attributes with their data masks, box and
/// normals (the mesh's where it has them). Textures are set apart, once their
/// files are there: api::set_textures().
void write_layer(const Mesh& mesh, MeshModel& layer);

/// Moves a layer by a matrix that applies after its own: into the layer's
/// matrix, or into the coordinates (then the layer's matrix becomes the
/// identity, and a mirroring one flips the faces).
void place_layer(const Eigen::Matrix4d& matrix, bool to_vertices, MeshModel& layer);

}  // namespace parts::host
