// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/depth/gallery.h"
#include "parts/depth/options.h"
#include "parts/depth/query.h"

namespace parts::depth {

/// How the query's pixels map into the examples' frame: turned by an angle,
/// scaled, and moved so that one point falls on another.
struct Placement {
  double scale = 1;     ///< pixels of the frame a pixel of the query
  double rotation = 0;  ///< degrees, anticlockwise as seen
  cv::Point2d from, to;

  cv::Matx23d matrix() const;   ///< query to frame
  cv::Matx23d inverse() const;  ///< frame to query
};

/// The query as an example's equal: its part in the frame, smoothed where it
/// gets smaller. planes {intensity}.
synthesis::PatchImage place(const DepthQuery& query, const Placement& placement, cv::Size frame);

/// How different two images are, each moved onto its foreground's centroid:
/// mean squared difference of intensities, contrast evened out, and of the masks.
double image_difference(const synthesis::PatchImage& a, const synthesis::PatchImage& b);

/// Scale and rotation in the image plane by which the query fits an example
/// best (thesis 4.3.3). Keeps the query as it is where another placement fits no
/// better by a clear margin.
Placement align_query(const DepthQuery& query, Gallery& gallery, const DepthOptions& options);

/// Without a search: as it is if it has the frame's size, else fitted into it.
Placement fit_query(const DepthQuery& query, cv::Size frame);

}  // namespace parts::depth
