#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace dkp_slam::viewer {

/// An answer to the page that is part text, part numbers or images:
///
///     u32 length of the JSON | JSON | zeros up to 8 bytes | sections, each filled up to 8 bytes
///
/// The JSON's field "sections" says of each by its name [offset behind the JSON, bytes].
/// Little-endian, as the machine.
class Container {
 public:
  void add(const std::string& name, std::string_view bytes);
  template <class T>
  void add(const std::string& name, const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    add(name,
        std::string_view(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)));
  }
  /// `head`: an object.
  std::string finish(nlohmann::json head) const;

 private:
  nlohmann::json sections_ = nlohmann::json::object();
  std::string data_;
};

}  // namespace dkp_slam::viewer
