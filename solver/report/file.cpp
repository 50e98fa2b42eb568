#include "report/file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <stdexcept>
#include <streambuf>
#include <string_view>
#include <utility>

#include "report/interrupts.hpp"

namespace extremal {
namespace {
namespace fs = std::filesystem;

constexpr int most_links = 40;  // as the kernel follows
constexpr mode_t permissions = 0666, permission_bits = 07777;
/// Bytes written between two looks at interrupts: a pipe that is ready takes as many without waiting.
constexpr std::size_t piece = 4096, file_piece = std::size_t{1} << 20;
constexpr int wait_milliseconds = 50;

[[noreturn]] void refuse(const std::string& path, int reason) {
  const char* const name = path == "-" ? "standard output" : path.c_str();
  throw std::runtime_error(fmt::format("cannot write {}: {}", name, std::strerror(reason)));
}

/// An open file of the system.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() { close(); }
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&&) = delete;

  int number() const { return number_; }
  bool close() {
    const int number = std::exchange(number_, -1);
    return number < 0 || ::close(number) == 0;
  }

 private:
  int number_;
};

/// A file that is open, as the place where a stream writes.
class FileBuffer : public std::streambuf {
 public:
  /// `most` bytes at once.
  FileBuffer(int descriptor, const std::string& path, std::size_t most)
      : descriptor_(descriptor), path_(path), most_(most), gathered_(std::min(most, gathering)) {
    setp(gathered_.data(), gathered_.data() + gathered_.size());
  }

 protected:
  int sync() override {
    write({pbase(), static_cast<std::size_t>(pptr() - pbase())});
    setp(gathered_.data(), gathered_.data() + gathered_.size());
    return 0;
  }
  int_type overflow(int_type c) override {
    sync();
    if (!traits_type::eq_int_type(c, traits_type::eof())) sputc(traits_type::to_char_type(c));
    return traits_type::not_eof(c);
  }
  std::streamsize xsputn(const char* text, std::streamsize count) override {
    if (count < epptr() - pptr()) return std::streambuf::xsputn(text, count);
    sync();
    write({text, static_cast<std::size_t>(count)});
    return count;
  }

 private:
  static constexpr std::size_t gathering = std::size_t{1} << 16;

  void write(std::string_view text) const {
    while (!text.empty()) {
      HeldInterrupts::check();
      pollfd ready{descriptor_, POLLOUT, 0};
      if (::poll(&ready, 1, wait_milliseconds) <= 0) continue;
      const ssize_t count = ::write(descriptor_, text.data(), std::min(most_, text.size()));
      if (count < 0 && errno != EINTR && errno != EAGAIN) refuse(path_, errno);
      if (count > 0) text.remove_prefix(static_cast<std::size_t>(count));
    }
  }

  int descriptor_;
  std::string path_;
  std::size_t most_;
  std::vector<char> gathered_;
};

void write_all(int descriptor, const FileContent& file, std::size_t most) {
  FileBuffer buffer(descriptor, file.path, most);
  std::ostream out(&buffer);
  out.exceptions(std::ios::badbit);  // so that what is thrown in the buffer passes through
  out << file.content;
  if (file.write) file.write(out);
  out.flush();
}

/// Where a path leads, links followed; the file need not exist.
fs::path target_of(const std::string& path) {
  fs::path target = path;
  std::error_code ignored;
  for (int k = 0; k < most_links && fs::is_symlink(target, ignored); ++k)
    target = target.parent_path() / fs::read_symlink(target, ignored);
  return target;
}

/// A file beside its place. It is removed unless it takes its place.
class Draft {
 public:
  explicit Draft(const FileContent& file) : path_(file.path), target_(target_of(file.path)) {
    std::error_code ignored;  // where no folder can be made, opening fails and says why
    fs::create_directories(target_.parent_path(), ignored);
    Descriptor out = open_beside();
    struct stat before;
    if (::stat(target_.c_str(), &before) == 0) ::fchmod(out.number(), before.st_mode & permission_bits);
    try {
      write_all(out.number(), file, file_piece);
      if (!out.close()) refuse(path_, errno);
    } catch (...) {
      remove();
      throw;
    }
  }
  ~Draft() { remove(); }
  Draft(Draft&& other) noexcept
      : path_(std::move(other.path_)),
        target_(std::move(other.target_)),
        name_(std::exchange(other.name_, {})) {}
  Draft& operator=(Draft&&) = delete;

  void take_place() {
    if (::rename(name_.c_str(), target_.c_str()) != 0) refuse(path_, errno);
    name_.clear();
  }

 private:
  /// Of a short name: that of the target may be as long as names can be.
  Descriptor open_beside() {
    for (int k = 0;; ++k) {
      name_ = (target_.parent_path() / fmt::format(".extremal-{}-{}", ::getpid(), k)).string();
      const int number = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, permissions);
      if (number >= 0) return Descriptor(number);
      if (errno != EEXIST) {
        name_.clear();
        refuse(path_, errno);
      }
    }
  }
  void remove() {
    if (!name_.empty()) ::unlink(name_.c_str());
    name_.clear();
  }

  std::string path_;
  fs::path target_;
  std::string name_;
};

bool is_stream(const std::string& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  return path == "-" || (fs::exists(status) && !fs::is_regular_file(status));
}

void write_stream(const FileContent& file) {
  if (file.path == "-") return write_all(STDOUT_FILENO, file, piece);
  Descriptor out(::open(file.path.c_str(), O_WRONLY | O_CLOEXEC));
  if (out.number() < 0) refuse(file.path, errno);
  write_all(out.number(), file, piece);
  if (!out.close()) refuse(file.path, errno);
}

void write_held(const std::vector<FileContent>& files) {
  std::vector<Draft> drafts;
  for (const FileContent& file : files)
    if (!is_stream(file.path)) drafts.emplace_back(file);
  for (const FileContent& file : files)
    if (is_stream(file.path)) write_stream(file);
  for (Draft& draft : drafts) draft.take_place();
}

}  // namespace

void write_files(const std::vector<FileContent>& files) {
  try {
    const HeldInterrupts held;
    write_held(files);
  } catch (const Interrupted&) {  // of a process that a signal does not end
    throw std::runtime_error("interrupted: no file was written");
  }
}

bool same_file(const std::string& a, const std::string& b) {
  if (is_stream(a) || is_stream(b)) return false;
  std::error_code error;
  if (fs::equivalent(a, b, error)) return true;
  const auto place = [&](const std::string& path) {
    const fs::path absolute = fs::absolute(target_of(path), error);
    const fs::path known = fs::weakly_canonical(absolute, error);
    return (error ? absolute : known).lexically_normal();
  };
  return place(a) == place(b);
}

std::string text_of(const std::function<void(std::ostream&)>& write) {
  std::ostringstream out;
  write(out);
  return std::move(out).str();
}

void write_file(const std::string& path, const std::function<void(std::ostream&)>& write) {
  write_files({{.path = path, .write = write}});
}

}  // namespace extremal
