#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace dkp_slam::viewer {

/// Who may ask. A page of somebody else's must not reach the server through the user's browser,
/// neither by asking from its own origin nor by a name that suddenly leads here (DNS rebinding).
struct AccessRules {
  std::string address = "127.0.0.1";  ///< listened on: an IP address
  std::string token;                  ///< that must be shown; empty: none needed
  std::string cookie;                 ///< name of the cookie that may show it
};

/// What of a request decides whether it is answered; empty where it did not say.
struct Asker {
  std::string method = "GET";
  std::string host = {}, origin = {};
  std::string fetch_site = {};  ///< the header Sec-Fetch-Site
  std::string cookies = {};     ///< the header Cookie
  std::string token = {};       ///< the parameter of the address
  bool data = true;             ///< asks for more than the page itself
};

/// Why a request is not answered.
struct Refusal {
  int status = 403;
  std::string reason;  ///< one line
};

/// Nothing where the request is in order.
std::optional<Refusal> refusal_of(const AccessRules& rules, const Asker& asker);

/// Whether this is an IP address, as --listen takes it.
bool is_address(const std::string& text);
/// Whether only this machine reaches it.
bool is_loopback(const std::string& address);
/// "127.0.0.1", "[::1]": an address as it stands before the port of a URL.
std::string in_url(const std::string& address);
/// 128 random bits, 32 hexadecimal digits. Throws `Error` where the system has none.
std::string make_token();
/// Takes the same time wherever they differ.
bool equal_in_constant_time(std::string_view a, std::string_view b);

}  // namespace dkp_slam::viewer
