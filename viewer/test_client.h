#pragma once

#include <cstdint>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

namespace dkp_slam::testing {

/// A connection to a port of this machine, and what comes back on it.
class Connection {
 public:
  explicit Connection(int port, int receive_buffer = 0)
      : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    if (receive_buffer > 0)
      setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof(receive_buffer));
    const timeval patience{10, 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0)
      throw std::runtime_error("nobody listens on port " + std::to_string(port));
  }
  ~Connection() { close(); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void send(const std::string& text) const {
    ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL);
  }
  /// Until `end` has come, or nothing more does.
  std::string read_until(const std::string& end) {
    while (received_.find(end) == std::string::npos && receive()) {
    }
    return received_;
  }
  std::string read_all() {
    while (receive()) {
    }
    return received_;
  }
  void forget() { received_.clear(); }
  void close() {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
  }

 private:
  bool receive() {
    char buffer[1 << 16];
    const ssize_t count = ::recv(socket_, buffer, sizeof(buffer), 0);
    if (count > 0) received_.append(buffer, static_cast<std::size_t>(count));
    return count > 0;
  }

  int socket_;
  std::string received_;
};

struct Answer {
  int status = 0;
  std::string head, body;
};

using Headers = std::map<std::string, std::string>;

/// One request on a connection of its own.
inline Answer ask(int port, const std::string& path, Headers headers = {},
                  const std::string& method = "GET", const std::string& body = "") {
  headers.try_emplace("Host", "127.0.0.1:" + std::to_string(port));
  headers["Connection"] = "close";
  if (method == "POST") headers["Content-Length"] = std::to_string(body.size());
  std::string request = method + " " + path + " HTTP/1.1\r\n";
  for (const auto& [name, value] : headers) request += name + ": " + value + "\r\n";
  Connection connection(port);
  connection.send(request + "\r\n" + body);
  const std::string all = connection.read_all();
  const std::size_t end = all.find("\r\n\r\n");
  if (end == std::string::npos) return {};
  return {std::stoi(all.substr(9, 3)), all.substr(0, end), all.substr(end + 4)};
}

/// The JSON at the head of a Container.
inline nlohmann::json head_of(const std::string& container) {
  std::uint32_t length = 0;
  if (container.size() < sizeof(length)) return nullptr;
  std::memcpy(&length, container.data(), sizeof(length));
  return nlohmann::json::parse(container.substr(sizeof(length), length));
}

/// The numbers of a section of it.
template <class T>
std::vector<T> section_of(const std::string& container, const std::string& name) {
  std::uint32_t length = 0;
  std::memcpy(&length, container.data(), sizeof(length));
  const std::size_t start = (sizeof(length) + length + 7) / 8 * 8;
  const nlohmann::json where = head_of(container).at("sections").at(name);
  std::vector<T> values(where[1].get<std::size_t>() / sizeof(T));
  if (values.empty()) return values;  // which has no address
  std::memcpy(values.data(), container.data() + start + where[0].get<std::size_t>(),
              values.size() * sizeof(T));
  return values;
}

}  // namespace dkp_slam::testing
