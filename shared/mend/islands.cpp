// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/islands.h"

#include <algorithm>

#include "parts/mesh/topology.h"
#include "parts/spatial/closest_face.h"

namespace parts::mend {

Islands::Islands(const Mesh& scan, const mesh::Loop& rim, double size)
    : scan_(scan), component_(mesh::vertex_components(scan)), loose_(scan.faces.size(), 0) {
  std::vector<char> own(scan.vertices.size(), 0);  // components: a rim may hold a tooth that hangs in a vertex
  for (int v : rim) own[component_[v]] = 1;
  std::vector<Box> box(scan.vertices.size());
  for (int v = 0; v < scan.vertex_count(); ++v) box[component_[v]].extend(scan.vertices[v]);
  Box hole;
  for (int v : rim) hole.extend(scan.vertices[v]);
  hole.min().array() -= 0.25 * size, hole.max().array() += 0.25 * size;
  for (int f = 0; f < scan.face_count(); ++f) {
    const int c = component_[scan.faces[f][0]];
    loose_[f] = !own[c] && hole.contains(box[c]) && box[c].diagonal().norm() < 0.8 * hole.diagonal().norm();
  }
}

bool Islands::any() const { return std::find(loose_.begin(), loose_.end(), 1) != loose_.end(); }

std::vector<char> Islands::covered_by(const Mesh& patch, double near, int& number) const {
  constexpr double kMostOfIt = 0.8;
  const spatial::ClosestFace on_patch(patch);
  std::vector<long> count(scan_.vertices.size(), 0), close(scan_.vertices.size(), 0);
  for (int f = 0; f < scan_.face_count(); ++f) {
    if (!loose_[f]) continue;
    const spatial::FaceHit hit = on_patch(scan_.center(f));
    const int c = component_[scan_.faces[f][0]];
    ++count[c];
    close[c] += hit.distance <= near && !hit.on_border && hit.normal.dot(scan_.area_vector(f)) > 0;
  }
  std::vector<char> covered(scan_.faces.size(), 0), seen(scan_.vertices.size(), 0);
  number = 0;
  for (int f = 0; f < scan_.face_count(); ++f) {
    const int c = component_[scan_.faces[f][0]];
    covered[f] = loose_[f] && double(close[c]) >= kMostOfIt * double(count[c]);
    if (covered[f] && !seen[c]) seen[c] = 1, ++number;
  }
  return covered;
}

}  // namespace parts::mend
