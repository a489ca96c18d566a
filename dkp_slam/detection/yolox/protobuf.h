#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Protobuf's wire format (protobuf.dev/programming-guides/encoding), as far as ONNX files need it.
namespace dkp_slam::protobuf {

enum class WireType : std::uint8_t { varint = 0, fixed64 = 1, delimited = 2, fixed32 = 5 };

/// One field of a message.
struct Field {
  std::uint64_t number = 0;
  WireType type = WireType::varint;
  std::uint64_t value = 0;  ///< of a varint
  std::string_view bytes;   ///< of any other: the data, without their length
};

/// The number at the start of `in`, which goes on behind it; nothing where the bytes are none.
std::optional<std::uint64_t> take_varint(std::string_view& in);

/// The field at the start of `in`, which goes on behind it; nothing where the bytes are none.
std::optional<Field> take_field(std::string_view& in);

/// Every length-delimited value of one field number.
std::vector<std::string_view> children(std::string_view message, std::uint64_t number);

/// The first of them; empty where there is none.
std::string_view child(std::string_view message, std::uint64_t number);

/// The bytes of a field.
std::string written(const Field& field);
std::string written(std::uint64_t number, std::uint64_t value);
std::string written(std::uint64_t number, std::string_view bytes);

}  // namespace dkp_slam::protobuf
