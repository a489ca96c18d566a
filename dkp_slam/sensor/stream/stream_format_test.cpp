#include "dkp_slam/sensor/stream/stream_format.h"

#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/error.h"

namespace dkp_slam::stream {
namespace {

using ::testing::HasSubstr;

Header small() {
  Header header;
  header.width = 4;
  header.height = 3;
  return header;
}

Header parsed(const std::string& bytes) {
  return parse_header(std::span<const char, header_bytes>(bytes.data(), header_bytes));
}
RecordHead parsed_head(const std::string& bytes, const Header& header) {
  return parse_record_head(
      std::span<const char, record_head_bytes>(bytes.data(), record_head_bytes), header);
}

template <class Action>
std::string message_of(Action action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(StreamFormat, IsLaidOutAsThePageSays) {
  Header header = small();
  header.colour = ColourFormat::rgb8;
  header.depth = DepthFormat::f32;
  header.camera_bytes = 5;
  header.depth_scale = 1.0;
  using namespace std::string_literals;
  EXPECT_EQ(encode(header),
            "DKPSLAM\0"s
            "\1\0\0\0\4\0\0\0\3\0\0\0\2\0\0\0\2\0\0\0\5\0\0\0\0\0\0\0\0\0\xF0\x3F"s);
  EXPECT_EQ(encode({RecordKind::frame, 100}), "FRME\x64\0\0\0"s);
  EXPECT_EQ(encode({RecordKind::end, 0}), "DONE\0\0\0\0"s);
  EXPECT_EQ(encode_stamps(1.0, 0.0), "\0\0\0\0\0\0\xF0\x3F\0\0\0\0\0\0\0\0"s);
}

TEST(StreamFormat, ReadsWhatItWrote) {
  Header header = small();
  header.depth_scale = 1000.0;
  EXPECT_EQ(parsed(encode(header)), header);
  // 4 x 3 pixels of 3 and 2 bytes behind two stamps, and one more each with a mask.
  for (const std::uint32_t bytes : {16 + 36 + 24, 16 + 36 + 24 + 12}) {
    const RecordHead head = parsed_head(encode({RecordKind::frame, bytes}), header);
    EXPECT_EQ(head.kind, RecordKind::frame);
    EXPECT_EQ(head.bytes, bytes);
  }
  EXPECT_EQ(parsed_head(encode({RecordKind::end, 0}), header).kind, RecordKind::end);
  header.colour = ColourFormat::grey8;
  header.depth = DepthFormat::f32;
  EXPECT_EQ(header.frame_bytes(false), 16U + 12 + 48);
}

TEST(StreamFormat, RefusesWhatIsNoHeader) {
  EXPECT_THAT(message_of([] { parsed(std::string(40, 'x')); }), HasSubstr("is no frame stream"));
  std::string bytes = encode(small());
  bytes[8] = 2;
  EXPECT_THAT(message_of([&] { parsed(bytes); }), HasSubstr("version 2"));
}

TEST(StreamFormat, RefusesHeadersThatAskForMoreThanACameraHas) {
  const auto problem = [](auto change) {
    Header header = small();
    change(header);
    return message_of([&] { parsed(encode(header)); });
  };
  EXPECT_THAT(problem([](Header& h) { h.width = 0; }), HasSubstr("0 x 3 pixels"));
  EXPECT_THAT(problem([](Header& h) { h.width = h.height = 65536; }),
              HasSubstr("65536 x 65536 pixels"));
  EXPECT_THAT(problem([](Header& h) { h.width = h.height = 0xFFFFFFFF; }), HasSubstr("pixels"));
  EXPECT_THAT(problem([](Header& h) { h.colour = ColourFormat{4}; }), HasSubstr("colour format 4"));
  EXPECT_THAT(problem([](Header& h) { h.depth = DepthFormat{0}; }), HasSubstr("depth format 0"));
  EXPECT_THAT(problem([](Header& h) { h.camera_bytes = 65537; }), HasSubstr("65537 bytes"));
  for (const double scale : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT(problem([&](Header& h) { h.depth_scale = scale; }),
                HasSubstr("depth units per metre"));
  }
}

TEST(StreamFormat, RefusesWhatIsNoRecord) {
  EXPECT_THAT(message_of([] { parsed_head("FRAME   ", small()); }),
              HasSubstr("where a record must begin"));
  EXPECT_THAT(message_of([] {
                parsed_head(encode({RecordKind::frame, 75}), small());
              }),
              HasSubstr("a frame of 75 bytes, where 4 x 3 pixels of its formats take 76, or 88"));
  EXPECT_THAT(message_of([] {
                parsed_head(encode({RecordKind::end, 1}), small());
              }),
              HasSubstr("where a record must begin"));
}

}  // namespace
}  // namespace dkp_slam::stream
