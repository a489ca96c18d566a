#include "viewer/access.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <sys/random.h>

#include "dkp_slam/error.h"

namespace dkp_slam::viewer {
namespace {

// A zero byte ends the text for inet_pton and not for those who compare it.
bool holds_zero(const std::string& text) { return text.find('\0') != std::string::npos; }

bool is_v4(const std::string& text) {
  in_addr address{};
  return !holds_zero(text) && inet_pton(AF_INET, text.c_str(), &address) == 1;
}

bool is_v6(const std::string& text) {
  in6_addr address{};
  return !holds_zero(text) && inet_pton(AF_INET6, text.c_str(), &address) == 1;
}

bool is_wildcard(const std::string& address) { return address == "0.0.0.0" || address == "::"; }

/// The name in a Host header, without port and brackets, in small letters; empty where it is none.
std::string name_of_host(std::string host) {
  std::transform(host.begin(), host.end(), host.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (host.starts_with('[')) {
    const std::size_t end = host.find(']');
    return end == std::string::npos ? "" : host.substr(1, end - 1);
  }
  return host.substr(0, host.find(':'));
}

bool host_is_ours(const AccessRules& rules, const std::string& host) {
  const std::string name = name_of_host(host);
  if (name.empty()) return false;
  if (name == "localhost" || name == "127.0.0.1" || name == "::1") return true;
  // Names can be made to lead anywhere, addresses cannot.
  return is_wildcard(rules.address) ? is_address(name) : name == rules.address;
}

/// Value of a cookie in "a=1; b=2"; empty where it is not among them.
std::string_view cookie_value(std::string_view cookies, std::string_view name) {
  while (!cookies.empty()) {
    const std::size_t end = std::min(cookies.find(';'), cookies.size());
    std::string_view one = cookies.substr(0, end);
    cookies.remove_prefix(std::min(end + 1, cookies.size()));
    while (one.starts_with(' ')) one.remove_prefix(1);
    if (one.starts_with(name) && one.size() > name.size() && one[name.size()] == '=')
      return one.substr(name.size() + 1);
  }
  return {};
}

}  // namespace

std::optional<Refusal> refusal_of(const AccessRules& rules, const Asker& asker) {
  if (!host_is_ours(rules, asker.host)) {
    return Refusal{403, "this host name is not served; use the address that dkp-slam printed"};
  }
  if (!asker.origin.empty() && asker.origin != "http://" + asker.host) {
    return Refusal{403, "asked from another origin"};
  }
  if (asker.data && !asker.fetch_site.empty() && asker.fetch_site != "same-origin" &&
      asker.fetch_site != "none") {
    return Refusal{403, "asked from another site"};
  }
  if (asker.method == "POST" && asker.origin.empty()) {
    return Refusal{403, "a command needs the header Origin"};
  }
  if (rules.token.empty()) return std::nullopt;
  const bool by_parameter = equal_in_constant_time(asker.token, rules.token);
  const bool by_cookie =
      equal_in_constant_time(cookie_value(asker.cookies, rules.cookie), rules.token);
  if (by_parameter || by_cookie) return std::nullopt;
  return Refusal{401, "needs the token; open the whole address that dkp-slam printed"};
}

bool is_address(const std::string& text) { return is_v4(text) || is_v6(text); }

bool is_loopback(const std::string& address) {
  return is_v4(address) ? address.starts_with("127.") : address == "::1";
}

std::string in_url(const std::string& address) {
  return is_v6(address) ? "[" + address + "]" : address;
}

std::string make_token() {
  std::array<std::uint8_t, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw Error("the system gives no random numbers, so no token can be made");
  std::string token;
  for (const std::uint8_t byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

bool equal_in_constant_time(std::string_view a, std::string_view b) {
  unsigned difference = a.size() == b.size() ? 0U : 1U;
  for (std::size_t i = 0; i < b.size(); ++i) {
    const char other = a.empty() ? '\0' : a[i % a.size()];
    difference |= static_cast<unsigned char>(other ^ b[i]);
  }
  return difference == 0;
}

}  // namespace dkp_slam::viewer
