#include "viewer/container.h"

#include <cstring>

#include "dkp_slam/json_text.h"

namespace dkp_slam::viewer {
namespace {

constexpr std::size_t unit = 8;  // bytes: a typed array's offset is a multiple of its element

void fill_up(std::string& text) { text.resize((text.size() + unit - 1) / unit * unit, '\0'); }

}  // namespace

void Container::add(const std::string& name, std::string_view bytes) {
  sections_[name] = {data_.size(), bytes.size()};
  data_.append(bytes);
  fill_up(data_);
}

std::string Container::finish(nlohmann::json head) const {
  head["sections"] = sections_;
  const std::string text = json_text(head, -1);
  const auto length = static_cast<std::uint32_t>(text.size());
  std::string all(sizeof(length), '\0');
  std::memcpy(all.data(), &length, sizeof(length));
  all += text;
  fill_up(all);
  return all + data_;
}

}  // namespace dkp_slam::viewer
