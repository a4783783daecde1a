// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/examples/render_example.h"
#include "parts/io/model_database.h"

namespace parts::examples {

struct MappingsReport {
  int objects = 0, examples = 0;
  double megabytes = 0;  ///< on disk
  std::string folder;    ///< of the images
};

/// Renders every model of a database from every view and stores the examples as
/// a project that MeshLab opens: heads.mlp, with images, depths, masks and back
/// depths in the folder heads_mappings beside it. The class's preset goes along,
/// and, for MeshLab to show, the surface of the first example as a mesh.
/// An older database of that name is replaced once the new one is complete;
/// after a failure or cancellation it is as it was.
/// @param output  the .mlp
/// @throws UserError  no model can be read, the output cannot be written, would
///                    replace a project that is no mapping database, or the disk
///                    or memory is too small
MappingsReport build_mappings(const io::ModelDatabase& models, const std::vector<render::View>& views,
                              const std::string& output, const ExampleOptions& options, Progress& progress);

}  // namespace parts::examples
