// Addresses of frame streams, and what a browser says to the live view before it is let in.
#include "dkp_slam/sensor/stream/channel.h"
#include "fuzz/target.h"
#include "viewer/access.h"

namespace dkp_slam::fuzz {
namespace {

void run(Bytes bytes) {
  const std::string text = text_of(bytes);
  takes([&] { StreamAddress::parse(text.c_str()); });  // as an argument: to the first zero

  viewer::AccessRules rules;
  rules.token = "0123456789abcdef";
  rules.cookie = "token";
  viewer::Asker asker;
  asker.host = "127.0.0.1:8080";
  std::string* const fields[] = {&asker.method,     &asker.host,    &asker.origin,
                                 &asker.fetch_site, &asker.cookies, &asker.token};
  std::size_t field = 0;
  for (std::size_t at = 0; at <= text.size() && field < std::size(fields); ++field) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    if (end > at) *fields[field] = text.substr(at, end - at);
    at = end + 1;
  }
  const auto refusal = refusal_of(rules, asker);
  if (refusal) {
    require(refusal->status >= 400 && !refusal->reason.empty(), "refused without a reason");
  } else {
    require(asker.token == rules.token || asker.cookies.find(rules.token) != std::string::npos,
            "let in without the token");
  }
  viewer::in_url(text);
  require(!viewer::is_address(text) || text == text.c_str(), "an address with a zero byte in it");
  require(!viewer::is_loopback(text) || viewer::is_address(text), "a loopback that is no address");
}

std::vector<std::string> seeds() {
  return {"tcp:[::1]:4000",
          "unix:/run/camera",
          "-",
          "tcp:70000",
          "::1",
          "GET\nlocalhost:80\nhttp://localhost:80\nsame-origin\ntoken=0123456789abcdef; a=b\n",
          "POST\n127.0.0.1:8080\n\ncross-site\n\n0123456789abcdef"};
}

const Registration registration({"address", run, seeds});

}  // namespace
}  // namespace dkp_slam::fuzz
