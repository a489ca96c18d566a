#include "dkp_slam/sensor/stream/channel.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

using Clock = std::chrono::steady_clock;
// A signal may be taken by another thread, so that no wait is longer than this between two looks.
constexpr int look_ms = 100;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

bool stopped(const ChannelOptions& options) { return options.stop && *options.stop; }

[[noreturn]] void fail(const std::string& name, const std::string& what) {
  throw Error(name + ": " + what);
}

/// One look at descriptors, a tenth of a second at most; those that are below 0 are left out.
template <std::size_t count>
void look_at(std::array<pollfd, count>& descriptors) {
  // An interruption leaves the answers of the last look.
  for (pollfd& d : descriptors) d.revents = 0;
  ::poll(descriptors.data(), descriptors.size(), look_ms);
}

/// What is there now, `to.size()` at most; 0 where the peer is gone.
std::size_t read_some(int descriptor, std::span<char> to) {
  ssize_t got = -1;
  do {
    got = ::read(descriptor, to.data(), to.size());
  } while (got < 0 && errno == EINTR);
  return got > 0 ? static_cast<std::size_t>(got) : 0;
}

class PipeInput : public ByteInput {
 public:
  PipeInput(int descriptor, std::string name, const ChannelOptions& options)
      : descriptor_(descriptor), name_(std::move(name)), options_(options) {}
  std::string name() const override { return name_; }
  bool has_peers() const override { return false; }
  bool next_peer(double) override { return !std::exchange(used_, true); }

  std::size_t read(std::span<char> to) override {
    std::size_t done = 0;
    Clock::time_point heard = Clock::now();
    bool said = false;
    while (done < to.size() && !stopped(options_)) {
      std::array looked{pollfd{descriptor_, POLLIN, 0}};
      look_at(looked);
      if (looked[0].revents == 0) {
        if (!said && seconds_since(heard) > options_.silence) {
          spdlog::warn("{}: nothing has come for {:.3g} s; still waiting, Ctrl-C ends the wait",
                       name_, options_.silence);
          said = true;
        }
        continue;
      }
      const std::size_t got = read_some(descriptor_, to.subspan(done));
      if (got == 0) break;
      done += got;
      heard = Clock::now();
    }
    return done;
  }

 private:
  const int descriptor_;
  const std::string name_;
  const ChannelOptions options_;
  bool used_ = false;
};

sockaddr_un unix_address(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof(address.sun_path)) {
    fail("unix:" + path, fmt::format("the path is too long for a socket; at most {} bytes",
                                     sizeof(address.sun_path) - 1));
  }
  std::copy(path.begin(), path.end(), std::begin(address.sun_path));
  return address;
}

/// Addresses that a TCP name stands for. Throws `Error`.
std::unique_ptr<addrinfo, void (*)(addrinfo*)> resolve(const StreamAddress& address,
                                                       const std::string& name) {
  addrinfo hints{}, *found = nullptr;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  const int problem = ::getaddrinfo(address.host.c_str(), address.port.c_str(), &hints, &found);
  if (problem != 0) {
    fail(name, fmt::format("{}; check the address", ::gai_strerror(problem)));
  }
  return {found, ::freeaddrinfo};
}

/// As a user writes it.
std::string text_of(const StreamAddress& address) {
  switch (address.kind) {
    case StreamAddress::Kind::unix_socket:
      return "unix:" + address.path;
    case StreamAddress::Kind::tcp: {
      const bool v6 = address.host.find(':') != std::string::npos;
      return fmt::format("tcp:{}{}{}:{}", v6 ? "[" : "", address.host, v6 ? "]" : "", address.port);
    }
    case StreamAddress::Kind::standard:
      break;
  }
  return "-";
}

/// Whether somebody listens at this Unix socket.
bool answers(const sockaddr_un& address) {
  const FileDescriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  return ::connect(socket.number(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) ==
             0 ||
         errno == EAGAIN;
}

FileDescriptor listen_at_path(const std::string& path, const std::string& name) {
  const sockaddr_un address = unix_address(path);
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::file_status there = fs::symlink_status(path, error);
  if (fs::is_socket(there)) {
    if (answers(address)) fail(name, "another program listens there; choose another path");
    fs::remove(path, error);  // a program that was killed left it
  } else if (fs::exists(there)) {
    fail(name, "is there and is no socket; choose another path");
  }
  FileDescriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (!socket.open() ||
      ::bind(socket.number(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0 ||
      ::listen(socket.number(), 1) != 0) {
    fail(name, fmt::format("cannot listen there: {}; choose another path", std::strerror(errno)));
  }
  return socket;
}

/// The port is 0 where any will do.
std::uint16_t port_of(int descriptor) {
  sockaddr_storage storage{};
  socklen_t size = sizeof(storage);
  ::getsockname(descriptor, reinterpret_cast<sockaddr*>(&storage), &size);
  return ntohs(storage.ss_family == AF_INET6
                   ? reinterpret_cast<const sockaddr_in6&>(storage).sin6_port
                   : reinterpret_cast<const sockaddr_in&>(storage).sin_port);
}

FileDescriptor listen_at_port(const StreamAddress& address, const std::string& name) {
  const auto addresses = resolve(address, name);
  FileDescriptor socket(
      ::socket(addresses->ai_family, SOCK_STREAM | SOCK_CLOEXEC, addresses->ai_protocol));
  const int yes = 1;  // a run that ended a moment ago does not keep the port
  if (!socket.open() ||
      ::setsockopt(socket.number(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes)) != 0 ||
      ::bind(socket.number(), addresses->ai_addr, addresses->ai_addrlen) != 0 ||
      ::listen(socket.number(), 1) != 0) {
    fail(name, fmt::format("cannot listen there: {}; choose another port", std::strerror(errno)));
  }
  return socket;
}

class SocketInput : public ByteInput {
 public:
  SocketInput(StreamAddress address, const ChannelOptions& options)
      : address_(std::move(address)), name_(text_of(address_)), options_(options) {
    const bool path = address_.kind == StreamAddress::Kind::unix_socket;
    listener_ = path ? listen_at_path(address_.path, name_) : listen_at_port(address_, name_);
    if (!path) {
      address_.port = std::to_string(port_of(listener_.number()));
      name_ = text_of(address_);
    }
    spdlog::info("waiting for a driver at {}", name_);
  }
  ~SocketInput() override {
    if (address_.kind == StreamAddress::Kind::unix_socket) ::unlink(address_.path.c_str());
  }
  SocketInput(const SocketInput&) = delete;
  SocketInput& operator=(const SocketInput&) = delete;

  std::string name() const override { return name_; }
  bool has_peers() const override { return true; }

  bool next_peer(double seconds) override {
    peer_ = FileDescriptor();
    const Clock::time_point start = Clock::now();
    while (!stopped(options_)) {
      std::array looked{pollfd{listener_.number(), POLLIN, 0}};
      look_at(looked);
      if (looked[0].revents != 0) {
        peer_ = FileDescriptor(::accept4(listener_.number(), nullptr, nullptr, SOCK_CLOEXEC));
        if (peer_.open()) return true;
      }
      if (seconds >= 0.0 && seconds_since(start) > seconds) return false;
    }
    return false;
  }

  std::size_t read(std::span<char> to) override {
    std::size_t done = 0;
    Clock::time_point heard = Clock::now();
    bool silent = false;
    while (done < to.size() && !stopped(options_)) {
      // A peer that hangs, or whose machine is gone, must not keep others out for ever.
      std::array looked{pollfd{peer_.number(), POLLIN, 0},
                        pollfd{silent ? listener_.number() : -1, POLLIN, 0}};
      look_at(looked);
      if (looked[0].revents != 0) {
        const std::size_t got = read_some(peer_.number(), to.subspan(done));
        if (got == 0) break;
        done += got;
        heard = Clock::now();
        silent = false;
      } else if (looked[1].revents != 0) {
        spdlog::warn("{}: another driver takes the place of the silent one", name_);
        break;
      } else if (!silent && seconds_since(heard) > options_.silence) {
        silent = true;
        spdlog::warn(
            "{}: the driver has sent nothing for {:.3g} s; still waiting, Ctrl-C ends "
            "the wait",
            name_, options_.silence);
      }
    }
    return done;
  }

 private:
  StreamAddress address_;
  std::string name_;
  const ChannelOptions options_;
  FileDescriptor listener_, peer_;
};

/// A connected socket, or nothing, with errno.
std::optional<FileDescriptor> try_connect(const StreamAddress& address) {
  if (address.kind == StreamAddress::Kind::unix_socket) {
    const sockaddr_un to = unix_address(address.path);
    FileDescriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    if (::connect(socket.number(), reinterpret_cast<const sockaddr*>(&to), sizeof(to)) == 0) {
      return socket;
    }
    return std::nullopt;
  }
  const auto to = resolve(address, text_of(address));
  FileDescriptor socket(::socket(to->ai_family, SOCK_STREAM | SOCK_CLOEXEC, to->ai_protocol));
  if (::connect(socket.number(), to->ai_addr, to->ai_addrlen) == 0) return socket;
  return std::nullopt;
}

}  // namespace

FileDescriptor::~FileDescriptor() {
  if (open()) ::close(number_);
}

bool StreamAddress::looks_like(std::string_view text) {
  return text == "-" || text.starts_with("unix:") || text.starts_with("tcp:");
}

StreamAddress StreamAddress::parse(const std::string& text) {
  StreamAddress address;
  if (text == "-") return address;
  if (text.starts_with("unix:") && text.size() > 5) {
    address.kind = Kind::unix_socket;
    address.path = text.substr(5);
    unix_address(address.path);
    return address;
  }
  if (text.starts_with("tcp:")) {
    address.kind = Kind::tcp;
    std::string rest = text.substr(4);
    if (const std::size_t colon = rest.rfind(':'); colon != std::string::npos) {
      address.host = rest.substr(0, colon);
      rest = rest.substr(colon + 1);
    }
    const std::string& host = address.host;
    if (host.size() > 2 && host.front() == '[' && host.back() == ']') {
      address.host = host.substr(1, host.size() - 2);
    }
    std::uint16_t port = 0;
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), port);
    if (error == std::errc() && end == rest.data() + rest.size() && !address.host.empty()) {
      address.port = rest;
      return address;
    }
  }
  fail(text, "is no address of a stream; give -, unix:PATH, tcp:PORT or tcp:HOST:PORT");
}

std::unique_ptr<ByteInput> ByteInput::open(const StreamAddress& address,
                                           const ChannelOptions& options) {
  if (address.kind != StreamAddress::Kind::standard) {
    return std::make_unique<SocketInput>(address, options);
  }
  if (::isatty(STDIN_FILENO) != 0) {
    fail("standard input", "is a terminal; send a frame stream into it (docs/frame-stream.md)");
  }
  return std::make_unique<PipeInput>(STDIN_FILENO, "standard input", options);
}

ByteOutput::ByteOutput(const StreamAddress& address, const ChannelOptions& options, double seconds)
    : name_(text_of(address)), options_(options) {
  if (address.kind == StreamAddress::Kind::standard) {
    name_ = "standard output";
    number_ = STDOUT_FILENO;
    if (::isatty(number_) != 0) {
      fail(name_, "is a terminal; send the stream into a pipe or a file, or give --to ADDRESS");
    }
    return;
  }
  const Clock::time_point start = Clock::now();
  for (;;) {
    if (auto connected = try_connect(address)) {
      owned_ = std::move(*connected);
      number_ = owned_.number();
      return;
    }
    const int reason = errno;
    if (stopped(options_) || seconds_since(start) > seconds) {
      fail(name_, fmt::format("nobody listens there: {}; start dkp-slam run --source {} first",
                              std::strerror(reason), name_));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(look_ms));
  }
}

bool ByteOutput::write(std::span<const char> bytes) {
  while (!bytes.empty()) {
    if (stopped(options_)) return false;
    std::array looked{pollfd{number_, POLLOUT, 0}};
    look_at(looked);
    if (looked[0].revents == 0) continue;
    // A pipe that has room for something may not have it for all: small pieces do not block.
    constexpr std::size_t piece = 4096;
    const bool pipe = !owned_.open();
    const ssize_t put =
        pipe ? ::write(number_, bytes.data(), std::min(bytes.size(), piece))
             : ::send(number_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (put < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    if (put < 0 && errno == EPIPE) fail(name_, "the reader has gone away");
    if (put < 0) fail(name_, std::strerror(errno));
    bytes = bytes.subspan(static_cast<std::size_t>(put));
  }
  return true;
}

}  // namespace dkp_slam
