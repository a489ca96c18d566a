#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace dkp_slam {

/// An open file, pipe or socket, closed with the object.
class FileDescriptor {
 public:
  explicit FileDescriptor(int number = -1) : number_(number) {}
  ~FileDescriptor();
  FileDescriptor(FileDescriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  int number() const { return number_; }
  bool open() const { return number_ >= 0; }

 private:
  int number_;
};

/// Where a stream comes from or goes to: "-" (standard input or output), "unix:PATH", "tcp:PORT"
/// (of this machine alone) or "tcp:HOST:PORT" (IPv6 addresses in brackets).
struct StreamAddress {
  enum class Kind { standard, unix_socket, tcp };
  Kind kind = Kind::standard;
  std::string path;                ///< of a Unix socket
  std::string host = "127.0.0.1";  ///< of TCP
  std::string port;                ///< of TCP; to listen on, 0 is any free one

  /// True for what has such a form, right or wrong; anything else is a folder.
  static bool looks_like(std::string_view text);
  /// Throws `Error` for what cannot be an address.
  static StreamAddress parse(const std::string& text);
};

struct ChannelOptions {
  /// Ends every wait when set, within a tenth of a second. May be null.
  const std::atomic<bool>* stop = nullptr;
  /// Seconds of silence after which it is said, once, that a driver sends nothing. From then on
  /// one that connects takes the place of one that is silent.
  double silence = 5.0;
};

/// The bytes of a pipe, or of those who connect to a socket, one after the other.
class ByteInput {
 public:
  /// Begins to listen where the address is a socket's. Throws `Error` where that cannot be done,
  /// and where the standard input is a terminal.
  static std::unique_ptr<ByteInput> open(const StreamAddress& address,
                                         const ChannelOptions& options);
  virtual ~ByteInput() = default;
  /// For messages: "standard input", "unix:/run/camera", "tcp:127.0.0.1:4000".
  virtual std::string name() const = 0;
  /// Fills `to` and returns its size; less where the peer is gone or `stop` is set.
  virtual std::size_t read(std::span<char> to) = 0;
  /// Whether another peer can come when this one is gone.
  virtual bool has_peers() const = 0;
  /// Ends the connection and waits for the next one; false when `stop` is set or, where it is not
  /// negative, this many seconds have passed. Of a pipe only the first call gives one.
  virtual bool next_peer(double seconds) = 0;
};

/// Where a driver writes to: the standard output, or a socket that it connects to.
class ByteOutput {
 public:
  /// Tries to connect for so many seconds. Throws `Error` where nobody listens, and where the
  /// standard output is a terminal.
  ByteOutput(const StreamAddress& address, const ChannelOptions& options, double seconds);
  /// False when `stop` is set before all is written. Throws `Error` when the reader is gone.
  bool write(std::span<const char> bytes);

 private:
  std::string name_;
  ChannelOptions options_;
  FileDescriptor owned_;
  int number_ = -1;
};

}  // namespace dkp_slam
