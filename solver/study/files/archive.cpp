#include "study/files/archive.hpp"

#include <fmt/format.h>
#include <minizip/unzip.h>
#include <minizip/zip.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <stdexcept>

namespace extremal {
namespace {

/// What the library takes for a file: `bytes`, or `view` where it only reads.
struct Memory {
  std::string bytes{};
  std::string_view view{};
  std::size_t at = 0;

  std::size_t size() const { return view.data() ? view.size() : bytes.size(); }
};

Memory& memory(void* stream) { return *static_cast<Memory*>(stream); }

uLong read(void*, void* stream, void* into, uLong count) {
  Memory& m = memory(stream);
  const std::string_view all = m.view.data() ? m.view : std::string_view(m.bytes);
  const std::string_view part = all.substr(std::min(m.at, all.size()), count);
  std::memcpy(into, part.data(), part.size());
  m.at += part.size();
  return part.size();
}

uLong write(void*, void* stream, const void* from, uLong count) {
  Memory& m = memory(stream);
  const auto* const first = static_cast<const char*>(from);
  const std::size_t known = std::min<std::size_t>(count, m.bytes.size() - m.at);
  std::copy_n(first, known, m.bytes.data() + m.at);
  m.bytes.append(first + known, count - known);
  m.at += count;
  return count;
}

long seek(void*, void* stream, ZPOS64_T offset, int origin) {
  Memory& m = memory(stream);
  const std::size_t from = origin == ZLIB_FILEFUNC_SEEK_END   ? m.size()
                           : origin == ZLIB_FILEFUNC_SEEK_CUR ? m.at
                                                              : 0;
  if (offset > m.size() - std::min(from, m.size())) return -1;
  m.at = from + offset;
  return 0;
}

zlib_filefunc64_def functions(Memory& m) {
  zlib_filefunc64_def f{};
  f.zopen64_file = [](void* opaque, const void*, int) { return opaque; };
  f.zread_file = read;
  f.zwrite_file = write;
  f.ztell64_file = [](void*, void* stream) -> ZPOS64_T { return memory(stream).at; };
  f.zseek64_file = seek;
  f.zclose_file = [](void*, void*) { return 0; };
  f.zerror_file = [](void*, void*) { return 0; };
  f.opaque = &m;
  return f;
}

void require(bool fine, const char* what) {
  if (!fine) throw std::runtime_error(what);
}

}  // namespace

std::string archive(const std::vector<ArchiveMember>& members) {
  constexpr std::size_t piece = std::size_t{1} << 30;  // the library counts in 32 bits
  Memory m;
  constexpr std::size_t beside = 512;  // what the archive says of a member
  std::size_t size = beside;
  for (const ArchiveMember& member : members) size += member.head.size() + member.content.size() + beside;
  m.bytes.reserve(size);
  zlib_filefunc64_def f = functions(m);
  const zipFile file = zipOpen2_64(nullptr, APPEND_STATUS_CREATE, nullptr, &f);
  require(file != nullptr, "an archive cannot be begun");
  zip_fileinfo info{};
  info.tmz_date = {0, 0, 0, 1, 0, 1980};  // the same bytes on every day
  for (const ArchiveMember& member : members) {
    const int large = member.head.size() + member.content.size() >= piece;
    bool fine = zipOpenNewFileInZip64(file, member.name.c_str(), &info, nullptr, 0, nullptr, 0, nullptr, 0, 0,
                                      large) == ZIP_OK;
    for (std::string_view rest : {std::string_view(member.head), member.content})
      while (fine && !rest.empty()) {
        const std::string_view part = rest.substr(0, piece);
        fine = zipWriteInFileInZip(file, part.data(), static_cast<unsigned>(part.size())) == ZIP_OK;
        rest.remove_prefix(part.size());
      }
    require(fine && zipCloseFileInZip(file) == ZIP_OK, "an archive cannot be written");
  }
  require(zipClose(file, nullptr) == ZIP_OK, "an archive cannot be ended");
  return std::move(m.bytes);
}

std::map<std::string, std::string> extract(std::string_view bytes, std::size_t most) {
  Memory m{{}, bytes};
  zlib_filefunc64_def f = functions(m);
  const std::unique_ptr<void, int (*)(unzFile)> file(unzOpen2_64(nullptr, &f), unzClose);
  require(file != nullptr, "this is no archive");
  std::map<std::string, std::string> contents;
  std::size_t total = 0;
  for (int state = unzGoToFirstFile(file.get()); state != UNZ_END_OF_LIST_OF_FILE;
       state = unzGoToNextFile(file.get())) {
    unz_file_info64 info{};
    char name[256];
    require(state == UNZ_OK && unzGetCurrentFileInfo64(file.get(), &info, name, sizeof name, nullptr, 0,
                                                       nullptr, 0) == UNZ_OK,
            "its list of members is damaged");
    total += std::min<std::size_t>(info.uncompressed_size, most + 1);
    if (total > most) throw std::runtime_error(fmt::format("holds more than {} MiB", most >> 20));
    std::string content(info.uncompressed_size, '\0');
    require(unzOpenCurrentFile(file.get()) == UNZ_OK, "a member is packed in a way that is not known");
    const int read = unzReadCurrentFile(file.get(), content.data(), static_cast<unsigned>(content.size()));
    const bool complete = read >= 0 && static_cast<std::size_t>(read) == content.size();
    require(complete && unzCloseCurrentFile(file.get()) == UNZ_OK, "a member is damaged");
    contents.emplace(std::string(name, std::min<std::size_t>(info.size_filename, sizeof name - 1)),
                     std::move(content));
  }
  return contents;
}

}  // namespace extremal
