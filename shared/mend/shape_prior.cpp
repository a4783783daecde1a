// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/shape_prior.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace parts::mend {

ShapePrior::ShapePrior(const std::vector<std::vector<Vec3>>& shapes, const std::vector<double>& weight, double size)
    : mean_(shapes[0].size(), Vec3::Zero()),
      differences_(3 * Eigen::Index(shapes[0].size()), shapes.size()),
      size_(size) {
  for (std::size_t i = 0; i < shapes.size(); ++i)
    for (std::size_t v = 0; v < mean_.size(); ++v) mean_[v] += weight[i] * shapes[i][v];
  for (std::size_t i = 0; i < shapes.size(); ++i)
    for (std::size_t v = 0; v < mean_.size(); ++v)
      differences_.block<3, 1>(3 * Eigen::Index(v), Eigen::Index(i)) = std::sqrt(weight[i]) * (shapes[i][v] - mean_[v]);
}

double ShapePrior::rough(const Vec3& a, const Vec3& b) const {
  constexpr double kAmplitude = 0.2;  // of the size; its length is the size
  return kAmplitude * kAmplitude * size_ * size_ * std::exp(-(a - b).norm() / size_);
}

std::vector<Vec3> ShapePrior::given(const std::vector<PlaneObservation>& seen) const {
  const int m = int(seen.size());
  Eigen::MatrixXd moves(m, differences_.cols());  // how the shapes' coefficients move what is seen
  Eigen::VectorXd wanted(m);
  for (int i = 0; i < m; ++i) {
    moves.row(i) = seen[i].normal.transpose() * differences_.middleRows<3>(3 * Eigen::Index(seen[i].vertex));
    wanted[i] = seen[i].normal.dot(seen[i].point - mean_[seen[i].vertex]);
  }
  Eigen::MatrixXd covariance = moves * moves.transpose();
  for (int i = 0; i < m; ++i) {
    for (int j = 0; j <= i; ++j)
      covariance(i, j) += seen[i].normal.dot(seen[j].normal) * rough(mean_[seen[i].vertex], mean_[seen[j].vertex]);
    covariance(i, i) += seen[i].noise * seen[i].noise;
  }
  const Eigen::VectorXd factor = covariance.selfadjointView<Eigen::Lower>().ldlt().solve(wanted);
  const Eigen::VectorXd blended = differences_ * (moves.transpose() * factor);
  std::vector<Vec3> shape = mean_;
  for (std::size_t v = 0; v < shape.size(); ++v) {
    shape[v] += blended.segment<3>(3 * Eigen::Index(v));
    for (int i = 0; i < m; ++i) shape[v] += rough(mean_[v], mean_[seen[i].vertex]) * factor[i] * seen[i].normal;
  }
  return shape;
}

}  // namespace parts::mend
