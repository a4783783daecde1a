// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/synthesis/search.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "parts/base/parallel.h"

namespace parts::synthesis {
namespace {

constexpr int leaf_size = 8, most_axes = 14, band_rows = 16;

// Windows larger than 7 x 7 are thinned out for the components.
constexpr int most_picks = 7;

}  // namespace

PatchTree::PatchTree(const std::vector<LevelExample>& examples, const PatchLayout& layout, long most, double share,
                     int threads) {
  long total = 0;
  for (const LevelExample& e : examples)
    if (e.active) total += std::count(e.plane.inside.begin(), e.plane.inside.end(), 1);
  int step = 1;
  while (total / (long(step) * step) > most) ++step;
  std::vector<Match> all;
  for (size_t k = 0; k < examples.size(); ++k) {
    const PatchPlane& p = examples[k].plane;
    if (!examples[k].active) continue;
    for (int y = 0; y < p.height; y += step)
      for (int x = y / step % step; x < p.width; x += step)
        if (p.inside[p.index(x, y)]) all.push_back({int(k), x, y});
  }
  if (all.empty()) return;

  find_axes(examples, layout, all, share, threads);
  std::vector<float> projected(all.size() * axes_);
  parallel_for(long(all.size()), threads, [&](long begin, long end) {
    Window w;
    for (long i = begin; i < end; ++i) {
      const LevelExample& e = examples[all[i].example];
      gather(e.plane, e.coverage, all[i].x, all[i].y, layout, w);
      for (int a = 0; a < axes_; ++a) projected[i * axes_ + a] = along(a, w);
    }
  });
  std::vector<int> order(all.size());
  std::iota(order.begin(), order.end(), 0);
  build(order, 0, int(order.size()), projected, all);
  leaves_.push_back(int(entries_.size()));
}

// Principal components of a sample, as rows of root-weighted windows and the position.
void PatchTree::find_axes(const std::vector<LevelExample>& examples, const PatchLayout& layout,
                          const std::vector<Match>& all, double share, int threads) {
  const int r = layout.radius(), thin = (2 * r) / most_picks + 1;
  std::vector<Lane> root;
  for (int j = -(r / thin) * thin; j <= r; j += thin)
    for (int i = -(r / thin) * thin; i <= r; i += thin)
      for (int lane = 0; lane < layout.lanes; ++lane) {
        const int pixel = (j + r) * layout.side + i + r;
        picks_.push_back(pixel * layout.lanes + lane);
        root.push_back((layout.gaussian[pixel] * float(thin * thin) * layout.active[lane]).sqrt());
      }
  const int lanes = int(picks_.size()), dims = lanes * 4 + 2;
  const long sample = std::min<long>(all.size(), 3000);
  Eigen::MatrixXf rows(sample, dims);
  parallel_for(sample, threads, [&](long begin, long end) {
    Window w;
    for (long i = begin; i < end; ++i) {
      const Match& m = all[i * long(all.size()) / sample];
      gather(examples[m.example].plane, examples[m.example].coverage, m.x, m.y, layout, w);
      for (int j = 0; j < lanes; ++j)
        for (int c = 0; c < 4; ++c) rows(i, 4 * j + c) = w.value[picks_[j]][c] * root[j][c];
      rows(i, dims - 2) = w.position.x(), rows(i, dims - 1) = w.position.y();
    }
  });
  const Eigen::RowVectorXf mean = rows.colwise().mean();
  rows.rowwise() -= mean;
  const Eigen::MatrixXf covariance = rows.transpose() * rows;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXf> solver(covariance);
  axes_ = share > 0 ? std::clamp(int(std::lround(share * dims)), 1, dims) : std::min(most_axes, dims);
  basis_.assign(long(axes_) * (lanes + 1), Lane::Zero());
  for (int a = 0; a < axes_; ++a) {
    const Eigen::VectorXf vector = solver.eigenvectors().col(dims - 1 - a);
    Lane* basis = &basis_[long(a) * (lanes + 1)];
    for (int j = 0; j < lanes; ++j)
      for (int c = 0; c < 4; ++c) basis[j][c] = vector[4 * j + c] * root[j][c];
    basis[lanes][0] = vector[dims - 2], basis[lanes][1] = vector[dims - 1];
  }
}

float PatchTree::along(int axis, const Window& window) const {
  const int lanes = int(picks_.size());
  const Lane* basis = basis_.data() + long(axis) * (lanes + 1);
  Lane sum = Lane::Zero();
  for (int j = 0; j < lanes; ++j) sum += basis[j] * window.value[picks_[j]];
  return sum.sum() + basis[lanes][0] * window.position.x() + basis[lanes][1] * window.position.y();
}

int PatchTree::build(std::vector<int>& order, int begin, int end, const std::vector<float>& rows,
                     std::vector<Match>& all) {
  const int node = int(nodes_.size());
  nodes_.emplace_back();
  if (end - begin <= leaf_size) {
    nodes_[node].left = int(leaves_.size());
    leaves_.push_back(int(entries_.size()));
    for (int i = begin; i < end; ++i) entries_.push_back(all[order[i]]);
    return node;
  }
  // The axis of the widest spread, at the median.
  int axis = 0;
  double widest = -1;
  for (int a = 0; a < axes_; ++a) {
    double sum = 0, squares = 0;
    for (int i = begin; i < end; ++i) {
      const double v = rows[long(order[i]) * axes_ + a];
      sum += v, squares += v * v;
    }
    const double spread = squares - sum * sum / (end - begin);
    if (spread > widest) widest = spread, axis = a;
  }
  const auto less = [&](int i, int j) {
    const float u = rows[long(i) * axes_ + axis], v = rows[long(j) * axes_ + axis];
    return u != v ? u < v : i < j;
  };
  const int middle = (begin + end) / 2;
  std::nth_element(order.begin() + begin, order.begin() + middle, order.begin() + end, less);
  nodes_[node].axis = axis;
  nodes_[node].split = rows[long(order[middle]) * axes_ + axis];
  const int left = build(order, begin, middle, rows, all);
  const int right = build(order, middle, end, rows, all);
  nodes_[node].left = left, nodes_[node].right = right;
  return node;
}

int PatchTree::leaf(const Window& window) const {
  int node = 0;
  while (nodes_[node].axis >= 0)  // few of the axes are asked
    node = along(nodes_[node].axis, window) < nodes_[node].split ? nodes_[node].left : nodes_[node].right;
  return nodes_[node].left;
}

namespace {

bool before(const Match& a, const Match& b) {
  if (a.example != b.example) return a.example < b.example;
  return a.y != b.y ? a.y < b.y : a.x < b.x;
}

struct Searcher {
  const PatchPlane& query;
  const cv::Mat& coverage;
  const std::vector<LevelExample>& examples;
  const PatchLayout& layout;
  const PatchTree* tree;
  std::vector<Match>& matches;
  std::vector<int> leaf;

  void offer(const Window& window, Match m, Match& best) const {
    const LevelExample& e = examples[m.example];
    if (m.x < 0 || m.y < 0 || m.x >= e.plane.width || m.y >= e.plane.height || !e.active) return;
    if (!e.plane.inside[e.plane.index(m.x, m.y)]) return;
    if (m.example == best.example && m.x == best.x && m.y == best.y) return;
    m.distance = distance(window, e.plane, m.x, m.y, layout, std::nextafter(best.distance, 1e30f));
    if (m.distance < best.distance || (m.distance == best.distance && before(m, best))) best = m;
  }

  // What a pixel at (dx, dy) found, moved here.
  void propagate(const Window& window, const std::vector<Match>& from, int x, int y, int dx, int dy,
                 Match& best) const {
    const int u = x + dx, v = y + dy;
    if (u < 0 || v < 0 || u >= query.width || v >= query.height) return;
    const long at = query.index(u, v);
    if (!query.inside[at]) return;
    const Match& m = from[at];
    if (m.example >= 0) offer(window, {m.example, m.x - dx, m.y - dy}, best);
    if (tree && leaf[at] >= 0)
      for (const Match* c = tree->begin(leaf[at]); c != tree->end(leaf[at]); ++c)
        offer(window, {c->example, c->x - dx, c->y - dy}, best);
  }

  // Distances of the old matches, and candidates of the tree.
  void propose(int y) {
    Window window;
    for (int x = 0; x < query.width; ++x) {
      const long at = query.index(x, y);
      if (!query.inside[at]) continue;
      gather(query, coverage, x, y, layout, window);
      Match& best = matches[at];
      best.distance = std::numeric_limits<float>::infinity();
      if (best.example >= 0) {
        const PatchPlane& e = examples[best.example].plane;
        if (e.inside[e.index(best.x, best.y)])
          best.distance = distance(window, e, best.x, best.y, layout, best.distance);
        else
          best = {};  // the finer level knows better where the foreground ends
      }
      if (!tree || tree->empty()) continue;
      leaf[at] = tree->leaf(window);
      for (const Match* c = tree->begin(leaf[at]); c != tree->end(leaf[at]); ++c) offer(window, *c, best);
    }
  }

  // Each row sees this pass' row before it, but at a band's edge the last pass'.
  void sweep(int begin, int end, int way, const std::vector<Match>& last) {
    Window window;
    for (int j = 0; j < end - begin; ++j)
      for (int i = 0; i < query.width; ++i) {
        const int y = way > 0 ? begin + j : end - 1 - j, x = way > 0 ? i : query.width - 1 - i;
        const long at = query.index(x, y);
        if (!query.inside[at]) continue;
        gather(query, coverage, x, y, layout, window);
        propagate(window, matches, x, y, -way, 0, matches[at]);
        propagate(window, j == 0 ? last : matches, x, y, 0, -way, matches[at]);
      }
  }

  void exhaust(int y) {
    Window window;
    for (int x = 0; x < query.width; ++x) {
      const long at = query.index(x, y);
      if (!query.inside[at]) continue;
      gather(query, coverage, x, y, layout, window);
      for (size_t k = 0; k < examples.size(); ++k)
        for (int v = 0; v < examples[k].plane.height; ++v)
          for (int u = 0; u < examples[k].plane.width; ++u) offer(window, {int(k), u, v}, matches[at]);
    }
  }
};

}  // namespace

void search(const PatchPlane& query, const cv::Mat& coverage, const std::vector<LevelExample>& examples,
            const PatchLayout& layout, const PatchTree* tree, int threads, std::vector<Match>& matches) {
  Searcher s{query, coverage, examples, layout, tree, matches, std::vector<int>(matches.size(), -1)};
  parallel_for(query.height, threads, [&](long begin, long end) {
    for (long y = begin; y < end; ++y) s.propose(int(y));
  });
  if (!tree) {
    parallel_for(query.height, threads, [&](long begin, long end) {
      for (long y = begin; y < end; ++y) s.exhaust(int(y));
    });
    return;
  }
  const int bands = (query.height + band_rows - 1) / band_rows;
  for (int way : {1, -1}) {
    const std::vector<Match> last = matches;
    parallel_for(bands, threads, [&](long begin, long end) {
      for (long b = begin; b < end; ++b)
        s.sweep(int(b) * band_rows, std::min(query.height, int(b + 1) * band_rows), way, last);
    });
  }
}

}  // namespace parts::synthesis
