// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/compose/assemble.h"

#include <numeric>

#include "parts/compose/clip_border.h"
#include "parts/seam/joined.h"
#include "parts/seam/weld.h"

namespace parts::compose {

void assemble(const cut::Model& a, seam::Clipped clipped_a, const cut::Model& b, seam::Clipped clipped_b,
              const SeamMeasure& measure, const ComposeOptions& options, Progress& progress, Assembly& t) {
  progress.stage("Stitching and smoothing", 75, 95);
  seam::Joined joined = seam::join_parts(a, clipped_a, b, clipped_b);
  ComposeReport& report = t.result.report;
  report.seam_edge = measure.edge;
  report.loops_a = int(joined.loops_a.size()), report.loops_b = int(joined.loops_b.size());
  if (options.stitch) {
    seam::weld_borders(joined, measure.step, report);
    t.flaws = seam::stitch_parts(joined, measure.max_gap, report);
    progress.at(0.6);
    t.flaws +=
        measure.edge * double(seam::finish_seam(joined, measure.edge, options.cut, options.smoothing, options.threads));
    report.blend = joined.blend;
  }
  t.result.composed = std::move(joined.mesh);
  t.result.face_from_b = std::move(joined.tag);
  t.result.clipped_a = std::move(clipped_a.mesh), t.result.clipped_b = std::move(clipped_b.mesh);
}

seam::Clipped take_model_faces(const cut::Model& model, const std::vector<char>& faces) {
  cut::MeshBorder border;
  border.split.mesh = model.prepared.mesh;
  border.split.source.resize(model.prepared.mesh.faces.size());
  std::iota(border.split.source.begin(), border.split.source.end(), 0);
  border.value.assign(model.prepared.mesh.vertices.size(), 0);
  for (int f : model.prepared.source_face) border.keep_level.push_back(faces[f]);
  return clip_border(border, model.keep, 0);
}

}  // namespace parts::compose
