// SPDX-License-Identifier: GPL-3.0-or-later
#include "database/search.h"

#include <algorithm>

#include "align/align.h"
#include "geometry/error.h"

namespace parts {

std::vector<Candidate> find_similar(const SearchQuery& query, const ModelDatabase& database,
                                    const SearchOptions& options, Progress& progress) {
  std::vector<char> part(query.mesh.faces.size(), 1);
  for (std::size_t f = 0; f < query.face_weight.size(); ++f) part[f] = query.face_weight[f] > 0;
  if (std::find(part.begin(), part.end(), 1) == part.end())
    throw UserError("No undamaged surface is left to compare with the models: choose a larger region.");
  std::vector<Candidate> found;
  for (int m = 0; m < database.size(); ++m) {
    progress.stage("Searching the models", 100 * m / database.size(), 100 * (m + 1) / database.size());
    const std::optional<Mesh> model = database.load_or_skip(m, progress);
    if (!model) continue;
    AlignOptions align;
    align.coarse = true, align.allow_scale = options.allow_scale, align.threads = options.threads;
    Progress silent;
    const AlignResult r = align_part_in_whole(query.mesh, part, *model, {}, align, silent);
    Candidate c;
    c.model = m;
    c.placement = Eigen::Affine3d(r.matrix).inverse();
    const double half = (query.region.isEmpty() ? query.mesh.bounds() : query.region).diagonal().norm() / 2;
    c.score = r.rms_after * c.placement.linear().col(0).norm() / half;
    found.push_back(c);
  }
  if (found.empty()) throw UserError("No model of the database can be used; the log says why each was skipped.");
  std::stable_sort(found.begin(), found.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score < b.score; });
  if (int(found.size()) > options.candidates) found.resize(std::size_t(std::max(1, options.candidates)));
  return found;
}

}  // namespace parts
