#include "dkp_slam/detection/yolox/protobuf.h"

namespace dkp_slam::protobuf {
namespace {

std::string varint(std::uint64_t value) {
  std::string bytes;
  for (; value >= 0x80; value >>= 7) bytes += static_cast<char>(value | 0x80);
  bytes += static_cast<char>(value);
  return bytes;
}

std::string tag(std::uint64_t number, WireType type) {
  return varint(number << 3 | static_cast<std::uint64_t>(type));
}

}  // namespace

std::optional<std::uint64_t> take_varint(std::string_view& in) {
  std::uint64_t value = 0;
  for (int shift = 0; shift < 64 && !in.empty(); shift += 7) {
    const auto byte = static_cast<unsigned char>(in.front());
    in.remove_prefix(1);
    value |= static_cast<std::uint64_t>(byte & 0x7F) << shift;
    if (byte < 0x80) return value;
  }
  return std::nullopt;
}

std::optional<Field> take_field(std::string_view& in) {
  const auto tag = take_varint(in);
  if (!tag) return std::nullopt;
  Field field;
  field.number = *tag >> 3;
  std::uint64_t length = 0;
  field.type = static_cast<WireType>(*tag & 7);
  switch (field.type) {
    case WireType::varint: {
      const auto value = take_varint(in);
      if (!value) return std::nullopt;
      field.value = *value;
      return field;
    }
    case WireType::fixed64:
      length = 8;
      break;
    case WireType::fixed32:
      length = 4;
      break;
    case WireType::delimited: {
      const auto value = take_varint(in);
      if (!value) return std::nullopt;
      length = *value;
      break;
    }
    default:
      return std::nullopt;
  }
  if (length > in.size()) return std::nullopt;
  field.bytes = in.substr(0, length);
  in.remove_prefix(length);
  return field;
}

std::vector<std::string_view> children(std::string_view message, std::uint64_t number) {
  std::vector<std::string_view> found;
  while (!message.empty()) {
    const auto field = take_field(message);
    if (!field) break;
    if (field->number == number) found.push_back(field->bytes);
  }
  return found;
}

std::string_view child(std::string_view message, std::uint64_t number) {
  const auto found = children(message, number);
  return found.empty() ? std::string_view() : found.front();
}

std::string written(const Field& field) {
  switch (field.type) {
    case WireType::varint:
      return written(field.number, field.value);
    case WireType::delimited:
      return written(field.number, field.bytes);
    default:
      return tag(field.number, field.type).append(field.bytes);
  }
}

std::string written(std::uint64_t number, std::uint64_t value) {
  return tag(number, WireType::varint).append(varint(value));
}

std::string written(std::uint64_t number, std::string_view bytes) {
  return tag(number, WireType::delimited).append(varint(bytes.size())).append(bytes);
}

}  // namespace dkp_slam::protobuf
