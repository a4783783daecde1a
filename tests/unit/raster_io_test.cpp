// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/io/raster_io.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <opencv2/imgcodecs.hpp>

#include "parts/base/error.h"
#include "parts/base/memory.h"
#include "parts/io/image_size.h"

namespace parts {
namespace {

namespace fs = std::filesystem;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();

/// Files of a test, in a folder of its own.
struct RasterIo : testing::Test {
  RasterIo()
      : folder(fs::temp_directory_path() /
               ("raster_io_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()))) {
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  ~RasterIo() override { fs::remove_all(folder); }

  std::string at(const std::string& name) const { return (folder / name).string(); }
  std::string save(const std::string& name, const cv::Mat& image) const {
    EXPECT_TRUE(cv::imwrite(at(name), image));
    return at(name);
  }
  std::string text(const std::string& name, const std::string& bytes) const {
    std::ofstream(at(name), std::ios::binary) << bytes;
    return at(name);
  }
  fs::path folder;
};

/// The sentence with which a call fails; it is one, and names the file.
template <class Call>
std::string sentence(const Call& call) {
  try {
    call();
  } catch (const UserError& e) {
    const std::string what = e.what();
    EXPECT_EQ(what.back(), '.');
    EXPECT_NE(what.find('"'), what.npos) << what;
    return what;
  }
  ADD_FAILURE() << "no UserError";
  return {};
}

#define EXPECT_SAYS(words, call) \
  EXPECT_NE(sentence([&] { call; }).find(words), std::string::npos) << sentence([&] { call; })

cv::Mat ramp() {
  cv::Mat depth(5, 7, CV_32F);
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 7; ++x) depth.at<float>(y, x) = 1.25f + 0.1f * float(x) + 1e-3f * float(y);
  depth.at<float>(0, 0) = kNaN;
  return depth;
}

TEST_F(RasterIo, DepthComesBackBitForBit) {
  for (const char* name : {"a.tif", "a.TIFF", "a.pfm"}) {
    io::write_depth(ramp(), at(name));
    const cv::Mat back = io::read_depth(at(name));
    ASSERT_EQ(back.size(), cv::Size(7, 5));
    for (int y = 0; y < 5; ++y)
      for (int x = 0; x < 7; ++x) {
        const float was = ramp().at<float>(y, x), is = back.at<float>(y, x);
        ASSERT_TRUE(was == is || (std::isnan(was) && std::isnan(is))) << name << " " << x << " " << y;
      }
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 3) << "no drafts are left";
}

TEST_F(RasterIo, BackgroundIsZeroNanAndInfinity) {
  cv::Mat depth = ramp();
  depth.at<float>(1, 1) = 0, depth.at<float>(1, 2) = kInf, depth.at<float>(1, 3) = -kInf;
  const cv::Mat back = io::read_depth(save("a.tif", depth));
  for (int x = 1; x <= 3; ++x) EXPECT_TRUE(std::isnan(back.at<float>(1, x)));
  EXPECT_EQ(cv::countNonZero(io::depth_mask(back)), 35 - 4);
}

TEST_F(RasterIo, ScaledPngOf16Bits) {
  cv::Mat raw(3, 4, CV_16U, cv::Scalar(1500));
  raw.at<std::uint16_t>(0, 0) = 0;
  raw.at<std::uint16_t>(2, 3) = 65535;
  const cv::Mat depth = io::read_depth(save("a.png", raw), 0.001);
  EXPECT_TRUE(std::isnan(depth.at<float>(0, 0)));
  EXPECT_FLOAT_EQ(depth.at<float>(1, 1), 1.5f);
  EXPECT_FLOAT_EQ(depth.at<float>(2, 3), 65.535f);
  cv::Mat thrice;
  cv::merge(std::vector<cv::Mat>(3, raw), thrice);
  EXPECT_FLOAT_EQ(io::read_depth(save("b.png", thrice)).at<float>(1, 1), 1500);
}

TEST_F(RasterIo, WhatIsNoDepth) {
  EXPECT_SAYS("8 bits", io::read_depth(save("grey.png", cv::Mat(4, 4, CV_8U, cv::Scalar(7)))));
  EXPECT_SAYS("channels", io::read_depth(save("rgb.png", cv::Mat(4, 4, CV_16UC3, cv::Scalar(7, 8, 9)))));
  EXPECT_SAYS("Z channel", io::read_depth(save("zero.tif", cv::Mat(4, 4, CV_32F, cv::Scalar(0)))));
  EXPECT_SAYS("background everywhere", io::read_depth(save("nan.tif", cv::Mat(4, 4, CV_32F, cv::Scalar(kNaN)))));
  EXPECT_SAYS("background everywhere", io::read_depth(save("inf.pfm", cv::Mat(4, 4, CV_32F, cv::Scalar(kInf)))));
  EXPECT_SAYS(".pfm", io::write_depth(ramp(), at("a.png")));
  EXPECT_SAYS("cannot be written", io::write_depth(ramp(), at("no/such/folder/a.tif")));
  fs::create_directory(at("folder.tif"));
  EXPECT_SAYS("cannot be written", io::write_depth(ramp(), at("folder.tif")));
}

TEST_F(RasterIo, GreyColourAndAlphaOf8And16Bits) {
  for (int depth : {CV_8U, CV_16U}) {
    const double unit = depth == CV_8U ? 1 : 257;
    cv::Mat colour(4, 6, CV_MAKETYPE(depth, 4), cv::Scalar(10 * unit, 20 * unit, 30 * unit, 255 * unit));
    colour.col(0).setTo(cv::Scalar(10 * unit, 20 * unit, 30 * unit, 0));
    const io::Image image = io::read_image(save("a.png", colour));
    ASSERT_EQ(image.color.type(), CV_8UC3);
    EXPECT_EQ(image.color.at<cv::Vec3b>(2, 2), cv::Vec3b(10, 20, 30));
    EXPECT_TRUE(image.has_alpha);
    EXPECT_EQ(cv::countNonZero(image.mask), 20);

    const io::Image grey = io::read_image(save("g.png", cv::Mat(4, 6, CV_MAKETYPE(depth, 1), cv::Scalar(50 * unit))));
    EXPECT_EQ(grey.color.at<cv::Vec3b>(0, 0), cv::Vec3b(50, 50, 50));
    EXPECT_FALSE(grey.has_alpha);
    EXPECT_EQ(cv::countNonZero(grey.mask), 24);
  }
  cv::Mat opaque(4, 6, CV_8UC4, cv::Scalar(1, 2, 3, 255));
  EXPECT_FALSE(io::read_image(save("o.png", opaque)).has_alpha) << "an alpha that hides nothing says nothing";
}

TEST_F(RasterIo, WhatIsNoImage) {
  EXPECT_SAYS("does not exist", io::read_image(at("missing.png")));
  EXPECT_SAYS("folder", io::read_image(folder.string()));
  EXPECT_SAYS("is empty", io::read_image(text("empty.png", "")));
  EXPECT_SAYS("cannot be read", io::read_image(text("words.png", "not an image at all, only words")));
  const std::string whole = save("whole.png", cv::Mat(64, 64, CV_8UC3, cv::Scalar(1, 2, 3)));
  std::ifstream in(whole, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  EXPECT_SAYS("cannot be read", io::read_image(text("cut.png", bytes.substr(0, bytes.size() / 2))));
  EXPECT_SAYS("transparent", io::read_image(save("clear.png", cv::Mat(4, 4, CV_8UC4, cv::Scalar(1, 2, 3, 0)))));
  EXPECT_SAYS("beyond 0 to 1", io::read_image(save("depth.tif", ramp())));
  EXPECT_SAYS("ending", io::write_image(cv::Mat(4, 4, CV_8U), at("a.txt")));
}

/// A PNG head that claims a size; nothing follows.
std::string png_of(std::uint32_t width, std::uint32_t height) {
  std::string s = std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16);
  for (std::uint32_t n : {width, height})
    for (int shift : {24, 16, 8, 0}) s += char(n >> shift & 255);
  return s + std::string("\x10\x06\0\0\0", 5) + std::string(40, '\0');
}

TEST_F(RasterIo, SizesAreToldBeforeAnythingIsAllocated) {
  EXPECT_SAYS("more than can be read", io::read_image(text("huge.png", png_of(2000000000, 2000000000))));
  if (available_memory() < 24e9) {
    EXPECT_SAYS("32000 x 32000 pixels, which need", io::read_image(text("large.png", png_of(32000, 32000))));
  }
  EXPECT_SAYS("more than can be read", io::read_depth(text("huge.pfm", "Pf\n900000 900000\n-1\n")));
}

TEST_F(RasterIo, HeadsOfTheFormats) {
  const cv::Mat colour(31, 57, CV_8UC3, cv::Scalar(1, 2, 3));
  for (const char* name : {"a.png", "a.jpg", "a.tif", "a.bmp", "a.ppm"}) {
    const auto head = io::read_image_head(save(name, colour));
    ASSERT_TRUE(head) << name;
    EXPECT_EQ(head->width, 57) << name;
    EXPECT_EQ(head->height, 31) << name;
  }
  for (const char* name : {"a.pfm", "b.tif"}) {
    const auto head = io::read_image_head(save(name, ramp()));
    ASSERT_TRUE(head) << name;
    EXPECT_EQ(head->width, 7);
    EXPECT_EQ(head->bytes, 4);
  }
  EXPECT_FALSE(io::read_image_head(text("t", "II*")));
  EXPECT_FALSE(io::read_image_head(text("u", std::string("II*\0\xff\xff\xff\xff", 8))));
  EXPECT_FALSE(io::read_image_head(text("v", "\xFF\xD8\xFF\xE0")));
}

TEST_F(RasterIo, Masks) {
  cv::Mat half(4, 6, CV_8U, cv::Scalar(0));
  half.colRange(0, 3).setTo(255);
  EXPECT_EQ(cv::countNonZero(io::read_mask(save("m.png", half))), 12);
  EXPECT_EQ(cv::countNonZero(io::read_mask(save("m16.png", cv::Mat(4, 6, CV_16U, cv::Scalar(65535))))), 24);
  cv::Mat alpha = io::with_alpha(cv::Mat(4, 6, CV_8UC3, cv::Scalar(0, 0, 0)), half);
  EXPECT_EQ(cv::countNonZero(io::read_mask(save("a.png", alpha))), 12) << "alpha says more than black";
  EXPECT_SAYS("6 x 4 pixels and its image 7 x 4", io::read_mask(at("m.png"), {7, 4}));
  EXPECT_SAYS("black everywhere", io::read_mask(save("b.png", cv::Mat(4, 6, CV_8U, cv::Scalar(0)))));
}

TEST_F(RasterIo, APhotographIsTurnedUpright) {
  // Orientation 6: the camera was held with its right side down.
  const std::string plain = save("p.jpg", cv::Mat(16, 32, CV_8UC3, cv::Scalar(1, 2, 3)));
  std::ifstream in(plain, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const std::string exif(
      "\xFF\xE1\0\x22"
      "Exif\0\0II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0",
      36);
  const std::string turned = text("t.jpg", bytes.substr(0, 2) + exif + bytes.substr(2));
  EXPECT_EQ(io::read_image(plain).color.size(), cv::Size(32, 16));
  EXPECT_EQ(io::read_image(turned).color.size(), cv::Size(16, 32));
}

TEST_F(RasterIo, SeveralFilesAreWrittenAllOrNone) {
  const cv::Mat depth(4, 6, CV_32F, cv::Scalar(2)), image(4, 6, CV_8U, cv::Scalar(9));
  {
    io::OutputFiles files;
    files.depth(depth, at("d.tif"));
    files.image(image, at("i.png"));
    files.image(image, "");
    EXPECT_FALSE(fs::exists(at("d.tif")) || fs::exists(at("i.png")));
    EXPECT_SAYS("cannot be written", files.image(image, at("nowhere/m.png")));
  }
  EXPECT_TRUE(fs::is_empty(folder)) << "drafts are left";
  io::OutputFiles files;
  files.depth(depth, at("d.tif"));
  files.image(image, at("i.png"));
  files.commit();
  EXPECT_EQ(io::read_depth(at("d.tif")).at<float>(1, 1), 2);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 2);
  io::OutputFiles::check_depth("");
  io::OutputFiles::check_image(at("j.png"));
  EXPECT_FALSE(fs::exists(at("j.png")));
  EXPECT_SAYS("cannot be written", io::OutputFiles::check_depth(at("nowhere/d.tif")));
  EXPECT_SAYS("no ending", io::OutputFiles::check_depth(at("d.png")));
  EXPECT_SAYS("no ending", io::OutputFiles::check_image(at("d.pfm")));
}

}  // namespace
}  // namespace parts
