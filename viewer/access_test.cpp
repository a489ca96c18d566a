#include "viewer/access.h"

#include <string>

#include <gtest/gtest.h>

namespace dkp_slam::viewer {
namespace {

/// 0 where it is answered.
int status_of(const AccessRules& rules, const Asker& asker) {
  const auto refusal = refusal_of(rules, asker);
  return refusal ? refusal->status : 0;
}

TEST(Access, TakesTheNamesOfThisMachineAndNoOther) {
  const AccessRules rules;
  for (const char* host : {"127.0.0.1:80", "localhost:8000", "LocalHost", "[::1]:80"})
    EXPECT_EQ(status_of(rules, {.host = host}), 0) << host;
  for (const char* host : {"", "evil.example", "evil.example:80", "127.0.0.1.evil.example",
                           "localhost.evil.example:80", "10.0.0.1:80", "[::1", "[]:80"})
    EXPECT_EQ(status_of(rules, {.host = host}), 403) << host;
}

TEST(Access, AWildcardTakesAddressesAndNoNames) {
  const AccessRules rules{"0.0.0.0", "", "c"};
  EXPECT_EQ(status_of(rules, {.host = "192.168.1.7:80"}), 0);
  EXPECT_EQ(status_of(rules, {.host = "[fe80::1]:80"}), 0);
  EXPECT_EQ(status_of(rules, {.host = "evil.example:80"}), 403);
  const AccessRules one{"192.168.1.7", "", "c"};
  EXPECT_EQ(status_of(one, {.host = "192.168.1.7:80"}), 0);
  EXPECT_EQ(status_of(one, {.host = "192.168.1.8:80"}), 403);
}

TEST(Access, RefusesOtherOrigins) {
  const AccessRules rules;
  EXPECT_EQ(status_of(rules, {.host = "localhost:80", .origin = "http://localhost:80"}), 0);
  for (const char* origin : {"http://evil.example", "null", "http://localhost:81",
                             "https://localhost:80", "http://127.0.0.1:80"})
    EXPECT_EQ(status_of(rules, {.host = "localhost:80", .origin = origin}), 403) << origin;
}

TEST(Access, ACommandNeedsAnOrigin) {
  const AccessRules rules;
  EXPECT_EQ(status_of(rules, {.method = "POST", .host = "localhost"}), 403);
  EXPECT_EQ(status_of(rules, {.method = "POST", .host = "localhost", .origin = "http://localhost"}),
            0);
}

TEST(Access, DataIsForItsOwnPageOnly) {
  const AccessRules rules;
  const auto status = [&](const char* site, bool data) {
    return status_of(rules, {.host = "localhost", .fetch_site = site, .data = data});
  };
  EXPECT_EQ(status("same-origin", true), 0);
  EXPECT_EQ(status("none", true), 0);  // typed by the user
  EXPECT_EQ(status("cross-site", true), 403);
  EXPECT_EQ(status("same-site", true), 403);
  EXPECT_EQ(status("cross-site", false), 0);  // a link to the page
}

TEST(Access, TheTokenIsShownByParameterOrCookie) {
  const AccessRules rules{"0.0.0.0", "00ff", "dkp"};
  const auto status = [&](const std::string& token, const std::string& cookies) {
    return status_of(rules, {.host = "10.0.0.1", .cookies = cookies, .token = token});
  };
  EXPECT_EQ(status("00ff", ""), 0);
  EXPECT_EQ(status("", "dkp=00ff"), 0);
  EXPECT_EQ(status("", "a=b; dkp=00ff; c=d"), 0);
  for (const char* cookies : {"", "dkp=00fe", "xdkp=00ff", "dkp", "dkp=00ff0", "dkpx=00ff"})
    EXPECT_EQ(status("", cookies), 401) << cookies;
  EXPECT_EQ(status("00f", ""), 401);
  EXPECT_EQ(status("00ff00ff", ""), 401);
}

TEST(Access, AddressesAreToldFromNames) {
  EXPECT_TRUE(is_address("0.0.0.0"));
  EXPECT_TRUE(is_address("::"));
  EXPECT_FALSE(is_address("localhost"));
  EXPECT_FALSE(is_address("1.2.3"));
  EXPECT_FALSE(is_address(std::string("1.2.3.4\0.example", 16)));
  EXPECT_TRUE(is_loopback("127.0.0.1"));
  EXPECT_TRUE(is_loopback("127.1.2.3"));
  EXPECT_TRUE(is_loopback("::1"));
  EXPECT_FALSE(is_loopback("0.0.0.0"));
  EXPECT_EQ(in_url("::1"), "[::1]");
}

TEST(Access, NoTwoTokensAreAlike) {
  const std::string token = make_token();
  EXPECT_EQ(token.size(), 32U);
  EXPECT_NE(token, make_token());
  EXPECT_TRUE(equal_in_constant_time(token, token));
  EXPECT_FALSE(equal_in_constant_time("", token));
}

}  // namespace
}  // namespace dkp_slam::viewer
