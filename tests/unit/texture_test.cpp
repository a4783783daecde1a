// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/render/texture.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "parts/base/error.h"
#include "support/folder.h"

namespace parts {
namespace {

namespace fs = std::filesystem;

struct TextureFiles : test::Folder {
  TextureFiles() {
    for (int x = 0; x < 6; ++x) gradient.col(x).setTo(cv::Scalar(30 * x, 20, 200 - 30 * x));
  }
  bool shows(const std::string& name, const cv::Mat& image) const {
    EXPECT_TRUE(cv::imwrite(at(name), image));
    return render::shows_as_texture(at(name), io::read_image(at(name)));
  }
  cv::Mat gradient{4, 6, CV_8UC3, cv::Scalar(0)};
};

TEST_F(TextureFiles, WhatTheHostShowsAsItIs) {
  for (const char* name : {"a.png", "a.PNG", "a.jpg", "a.bmp"}) EXPECT_TRUE(shows(name, gradient)) << name;
  EXPECT_TRUE(shows("grey.png", cv::Mat(4, 6, CV_8U, cv::Scalar(9))));
  EXPECT_FALSE(shows("a.tif", gradient));
  EXPECT_FALSE(shows("deep.png", cv::Mat(4, 6, CV_16UC3, cv::Scalar(9000, 1, 1))));
  cv::Mat mask(4, 6, CV_8U, cv::Scalar(255));
  EXPECT_TRUE(shows("opaque.png", io::with_alpha(gradient, mask)));
  mask.at<uchar>(0, 0) = 0;
  EXPECT_FALSE(shows("alpha.png", io::with_alpha(gradient, mask)));
}

TEST_F(TextureFiles, APhotographHeldUpsideDownIsNot) {
  for (const bool grey : {false, true}) {
    cv::Mat image = gradient;
    if (grey) cv::extractChannel(gradient, image, 0);
    ASSERT_TRUE(shows("p.jpg", image));
    std::ifstream in(at("p.jpg"), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    const std::string exif(
        "\xFF\xE1\0\x22"
        "Exif\0\0II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x03\0\0\0\0\0\0\0",
        36);
    std::ofstream(at("t.jpg"), std::ios::binary) << bytes.substr(0, 2) << exif << bytes.substr(2);
    EXPECT_FALSE(render::shows_as_texture(at("t.jpg"), io::read_image(at("t.jpg"))));
  }
}

TEST_F(TextureFiles, ColoursReachBeyondTheForeground) {
  cv::Mat mask(4, 6, CV_8U, cv::Scalar(0));
  mask(cv::Rect(2, 1, 2, 2)).setTo(255);
  const cv::Mat out = render::extend_colors(gradient, mask);
  EXPECT_EQ(out.at<cv::Vec3b>(0, 0), gradient.at<cv::Vec3b>(1, 2));
  EXPECT_EQ(out.at<cv::Vec3b>(3, 5), gradient.at<cv::Vec3b>(2, 3));
  EXPECT_EQ(out.at<cv::Vec3b>(1, 3), gradient.at<cv::Vec3b>(1, 3));
  EXPECT_EQ(cv::norm(render::extend_colors(gradient, cv::Mat::zeros(4, 6, CV_8U)), gradient, cv::NORM_INF), 0);
}

std::string write(const cv::Mat& color, const cv::Mat& mask, const render::TextureTarget& target) {
  OutputFiles files;
  std::string name = render::add_texture(files, color, mask, target);
  files.commit();
  return name;
}

TEST_F(TextureFiles, TwoRunsDoNotTakeOneName) {
  const cv::Mat all(4, 6, CV_8U, cv::Scalar(255));
  const render::TextureTarget beside{"", at("face.tif"), {}};
  OutputFiles one, two;
  EXPECT_EQ(render::add_texture(one, gradient, all, beside), at("face_texture.png"));
  EXPECT_EQ(render::add_texture(two, 255 - gradient, all, beside), at("face_texture_2.png"));
  one.commit(), two.commit();
  EXPECT_EQ(cv::norm(cv::imread(at("face_texture.png")), gradient, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(cv::imread(at("face_texture_2.png")), 255 - gradient, cv::NORM_INF), 0);
}

TEST_F(TextureFiles, NothingThatIsThereIsReplaced) {
  const cv::Mat all(4, 6, CV_8U, cv::Scalar(255));
  const render::TextureTarget beside{"", at("face.tif"), {}};
  EXPECT_EQ(write(gradient, all, beside), at("face_texture.png"));
  EXPECT_EQ(write(gradient, all, beside), at("face_texture.png")) << "the same picture";
  EXPECT_EQ(write(255 - gradient, all, beside), at("face_texture_2.png"));
  EXPECT_EQ(cv::norm(cv::imread(at("face_texture.png")), gradient, cv::NORM_INF), 0);

  const render::TextureTarget mine{at("mine.png"), at("face.tif"), {"", at("face_texture.png")}};
  EXPECT_EQ(write(gradient, all, mine), at("mine.png"));
  EXPECT_EQ(write(255 - gradient, all, mine), at("mine.png")) << "asked for by name";
  const render::TextureTarget input{at("face_texture.png"), at("face.tif"), mine.inputs};
  EXPECT_THROW(write(255 - gradient, all, input), UserError);
  EXPECT_EQ(cv::norm(cv::imread(at("face_texture.png")), gradient, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace parts
