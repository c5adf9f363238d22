#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/picture/rgb_image.hpp>
#include <softkin/vision/dots.hpp>
#include <softkin/vision/pictures.hpp>
#include <vision/rendering.hpp>

#include "../cli/run_program.hpp"

namespace {

using namespace softkin;
using namespace softkin::testing;
using namespace softkin::vision;

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const InvalidInput& error) {
    return error.what();
  } catch (const std::filesystem::filesystem_error& error) {
    return error.what();
  }
  return "accepted";
}

/// A dot that moves along a line at 24 mm a second.
RgbImage frame_at(double time) {
  const Photograph photo{.width = 160, .height = 120, .to_picture = straight(4, {0, 119}), .blur = 0.8};
  return render(photo, discs_on({{Vec2(6 + 24 * time, 10 + 3 * time), 3, red}}));
}

cv::Mat bgr_of(const RgbImage& picture) {
  cv::Mat bgr;
  cv::cvtColor(cv::Mat(picture.height, picture.width, CV_8UC3, const_cast<std::uint8_t*>(picture.bytes.data())), bgr,
               cv::COLOR_RGB2BGR);
  return bgr;
}

TEST(Pictures, AreReadAsTheyWereWritten) {
  prepare_opencv(1);
  const TemporaryFolder folder;
  const RgbImage picture = frame_at(0);
  const RgbImage read = read_picture(folder.write("a.png", encode_png(picture)));
  EXPECT_EQ(read.width, 160);
  EXPECT_EQ(read.bytes, picture.bytes);
  ASSERT_TRUE(cv::imwrite(folder / "a.jpg", bgr_of(picture), {cv::IMWRITE_JPEG_QUALITY, 95}));
  EXPECT_EQ(read_picture(folder / "a.jpg").height, 120);
}

TEST(Pictures, RefusesWhatCannotBeRead) {
  prepare_opencv(1);
  const TemporaryFolder folder;
  const std::string png = encode_png(frame_at(0));
  ASSERT_TRUE(cv::imwrite(folder / "a.jpg", bgr_of(frame_at(0))));
  const std::string jpeg = read_text(folder / "a.jpg");
  const auto refused = [&](const std::string& name, const std::string& content) {
    const std::string file = folder.write(name, content);
    const std::string message = message_of([&] { (void)read_picture(file); });
    EXPECT_NE(message.find(name), std::string::npos) << message;
    return message;
  };
  EXPECT_NE(refused("text.png", "hello").find("not a picture"), std::string::npos);
  EXPECT_NE(refused("empty.png", "").find("not a picture"), std::string::npos);
  EXPECT_NE(refused("half.jpg", jpeg.substr(0, jpeg.size() / 2)).find("cut off"), std::string::npos);
  EXPECT_NE(refused("half.png", png.substr(0, png.size() / 2)), "accepted");
  EXPECT_NE(refused("small.png", encode_png(RgbImage(8, 8))).find("smaller"), std::string::npos);
  EXPECT_NE(message_of([&] { (void)read_picture(folder / "none.png"); }).find("none.png"), std::string::npos);
}

TEST(Film, VideoIsReadFrameByFrameWithItsClock) {
  prepare_opencv(1);
  const TemporaryFolder folder;
  cv::VideoWriter writer(folder / "film.avi", cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 12.5, cv::Size(160, 120));
  if (!writer.isOpened()) GTEST_SKIP() << "this OpenCV writes no video";
  for (int i = 0; i < 10; ++i) writer.write(bgr_of(frame_at(i / 12.5)));
  writer.release();
  Film film({std::filesystem::path(folder / "film.avi")}, {});
  EXPECT_DOUBLE_EQ(film.rate(), 12.5);
  int count = 0;
  for (auto frame = film.next(); frame; frame = film.next(), ++count) {
    EXPECT_NEAR(frame->time, count / 12.5, 1e-12);
    const MarkerPlace dot = find_dot(frame->picture, Colour("red"), PlaneView({}, 0.25), "red");
    EXPECT_NEAR(dot.pixel.x(), 4 * (6 + 24 * frame->time), 0.3);
    EXPECT_NEAR(dot.pixel.y(), 119 - 4 * (10 + 3 * frame->time), 0.3);
  }
  EXPECT_EQ(count, 10);
  Film slow({std::filesystem::path(folder / "film.avi")}, 5);
  (void)slow.next();
  EXPECT_DOUBLE_EQ(slow.next()->time, 0.2);
}

TEST(Film, FolderIsReadInTheOrderOfItsNumbers) {
  prepare_opencv(1);
  const TemporaryFolder folder;
  for (const int i : {11, 9, 10}) folder.write("shot" + std::to_string(i) + ".png", encode_png(frame_at(i - 9)));
  folder.write("notes.txt", "no picture");
  Film film({std::filesystem::path(folder / "")}, 2);
  for (const int i : {9, 10, 11}) {
    const auto frame = film.next();
    ASSERT_TRUE(frame.has_value());
    EXPECT_NE(frame->name.find("shot" + std::to_string(i)), std::string::npos);
    EXPECT_DOUBLE_EQ(frame->time, (i - 9) / 2.0);
  }
  EXPECT_FALSE(film.next().has_value());
  const auto refused = [&](std::optional<double> rate) {
    return message_of([&] { (void)Film({std::filesystem::path(folder / "")}, rate); });
  };
  EXPECT_NE(refused({}).find("frames per second"), std::string::npos);
  EXPECT_NE(refused(-1).find("above 0"), std::string::npos);
  folder.write("shot14.png", encode_png(frame_at(0)));
  EXPECT_NE(refused(2).find("the frame before it is shot11.png"), std::string::npos) << refused(2);
  folder.write("last.png", encode_png(frame_at(0)));
  EXPECT_NE(refused(2).find("number"), std::string::npos);
  EXPECT_NE(
      message_of([&] { (void)Film({std::filesystem::path(folder.write("bad.mp4", "no video"))}, {}); }).find("bad.mp4"),
      std::string::npos);
}

}  // namespace
