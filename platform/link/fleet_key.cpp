#include "platform/link/fleet_key.h"

#include <sodium.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string_view>
#include <utility>

#include "platform/base/ensure.h"
#include "platform/linux/errno_text.h"
#include "platform/linux/input_file.h"
#include "platform/linux/whole_file.h"

namespace zenith {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kHeader = "zenith-fleet-key 1";
constexpr std::size_t kMaxFileBytes = 1024;

// The file's text, wiped at the end.
struct SecretText {
  std::array<char, kMaxFileBytes> text = {};
  std::size_t size = 0;

  SecretText() = default;
  SecretText(const SecretText&) = delete;
  SecretText& operator=(const SecretText&) = delete;
  ~SecretText() { sodium_memzero(text.data(), text.size()); }

  void append(std::string_view piece) {
    size += piece.copy(text.data() + size, text.size() - size);
  }
  std::string_view view() const { return {text.data(), size}; }
};

Error error_of(const fs::path& file, const std::string& what) {
  return Error{"key file " + file.string() + ": " + what};
}

Status read_text(const fs::path& file, SecretText& out, struct stat& info) {
  if (::stat(file.c_str(), &info) != 0 && errno == ENOENT) {
    return error_of(file, errno_text(ENOENT) + "; `zenith key new " + file.string() +
                              "` makes one, to be copied to all robots");
  }
  const auto opened = open_secret(file.string());
  if (!opened) {
    const bool known = S_ISREG(info.st_mode) && (info.st_mode & S_IRWXO) != 0;
    return Error{
        "key file " + opened.error().message +
        (known ? "\nand when others may have read it: zenith key rotate " + file.string() : "")};
  }
  if (::fstat(opened->fd.get(), &info) != 0) return error_of(file, errno_text(errno));
  const std::ptrdiff_t size = read_fully(opened->fd.get(), out.text.data(), out.text.size());
  if (size < 0) return error_of(file, errno_text(errno));
  if (static_cast<std::size_t>(size) == out.text.size()) {
    return error_of(file, "is longer than a key file");
  }
  out.size = static_cast<std::size_t>(size);
  return {};
}

std::string_view trimmed(std::string_view line) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t begin = line.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) return {};
  return line.substr(begin, line.find_last_not_of(kBlank) - begin + 1);
}

// The next line that says something; empty at the end.
std::string_view next_line(std::string_view& rest) {
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = trimmed(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (!line.empty() && line[0] != '#') return line;
  }
  return {};
}

bool parse_key(std::string_view line, SecretKey& out) {
  std::size_t size = 0;
  const char* end = nullptr;
  std::uint8_t* bytes = out.bytes().data();
  const bool is_hex = line.size() == 2 * SecretKey::kBytes;
  const int status =
      is_hex
          ? sodium_hex2bin(bytes, SecretKey::kBytes, line.data(), line.size(), nullptr, &size, &end)
          : sodium_base642bin(bytes, SecretKey::kBytes, line.data(), line.size(), nullptr, &size,
                              &end, sodium_base64_VARIANT_ORIGINAL);
  return status == 0 && size == SecretKey::kBytes && end == line.data() + line.size();
}

Status parse(const fs::path& file, std::string_view text, FleetKeys& out) {
  text = without_mark(text);
  if (next_line(text) != kHeader) {
    return error_of(file, "does not begin with the line \"" + std::string(kHeader) +
                              "\"; is it a key file? `zenith key new` makes one");
  }
  const std::string_view current = next_line(text);
  const std::string_view previous = next_line(text);
  constexpr const char* kForm = " is not 32 bytes as base64 (44 characters) or 64 hex digits";
  if (current.empty()) return error_of(file, "holds no key");
  if (!parse_key(current, out.current)) return error_of(file, std::string("its key") + kForm);
  out.has_previous = !previous.empty();
  if (out.has_previous && !parse_key(previous, out.previous)) {
    return error_of(file, std::string("its second key") + kForm);
  }
  if (!next_line(text).empty()) return error_of(file, "holds more than two keys");
  if (sodium_is_zero(out.current.bytes().data(), SecretKey::kBytes) != 0) {
    return error_of(file, "its key is all zeros; `zenith key rotate` makes a new one");
  }
  return {};
}

void append_key(SecretText& text, const SecretKey& key) {
  char base64[sodium_base64_ENCODED_LEN(SecretKey::kBytes, sodium_base64_VARIANT_ORIGINAL)];
  sodium_bin2base64(base64, sizeof base64, key.bytes().data(), SecretKey::kBytes,
                    sodium_base64_VARIANT_ORIGINAL);
  text.append(base64);
  text.append("\n");
  sodium_memzero(base64, sizeof base64);
}

void compose(SecretText& text, const FleetKeys& keys) {
  text.append(kHeader);
  text.append("\n# All robots of a fleet have this file. Who has it may change their maps.\n");
  append_key(text, keys.current);
  if (!keys.has_previous) return;
  text.append("# Another one, which only opens.\n");
  append_key(text, keys.previous);
}

}  // namespace

SecretKey::~SecretKey() {
  sodium_memzero(bytes_.data(), bytes_.size());
}

bool SecretKey::operator==(const SecretKey& other) const {
  return sodium_memcmp(bytes_.data(), other.bytes_.data(), kBytes) == 0;
}

void prepare_cryptography() {
  ensure(sodium_init() >= 0, "libsodium cannot be used: no randomness?");
}

std::uint64_t secret_number() {
  prepare_cryptography();
  std::uint64_t number = 0;
  randombytes_buf(&number, sizeof number);
  return number;
}

SecretKey SecretKey::random() {
  SecretKey key;
  prepare_cryptography();
  randombytes_buf(key.bytes_.data(), kBytes);
  return key;
}

KeyHint key_hint(const SecretKey& fleet_key) {
  constexpr std::string_view kPurpose = "zenith key hint";
  std::array<std::uint8_t, 32> hash;
  crypto_generichash(hash.data(), hash.size(),
                     reinterpret_cast<const unsigned char*>(kPurpose.data()), kPurpose.size(),
                     fleet_key.bytes().data(), SecretKey::kBytes);
  return {hash[0], hash[1]};
}

std::string hint_text(const KeyHint& hint) {
  char text[2 * std::tuple_size_v<KeyHint> + 1];
  sodium_bin2hex(text, sizeof text, hint.data(), hint.size());
  return text;
}

std::string keys_text(const FleetKeys& keys) {
  std::string text = hint_text(key_hint(keys.current));
  if (keys.has_previous) text += "; " + hint_text(key_hint(keys.previous)) + " only opens";
  return text;
}

Result<FleetKeys> read_fleet_keys(const fs::path& file) {
  SecretText text;
  struct stat info = {};
  if (const Status read = read_text(file, text, info); !read) return read.error();
  FleetKeys keys;
  if (const Status parsed = parse(file, text.view(), keys); !parsed) return parsed.error();
  return keys;
}

Status create_fleet_key(const fs::path& file) {
  SecretText text;
  FleetKeys keys;
  keys.current = SecretKey::random();
  compose(text, keys);
  struct stat info = {};
  if (::lstat(file.c_str(), &info) == 0) {
    return error_of(file, "is there already and stays; `zenith key rotate` puts a new key into it");
  }
  constexpr mode_t kOwnerAlone = 0600;
  const Status written =
      write_whole_file(file, text.view(), {.replace = false, .mode = kOwnerAlone});
  return written ? written : error_of(file, written.error().message);
}

namespace {

// The file is replaced as a whole by what `change` makes of its keys.
template <typename Change>
Status change_file(const fs::path& file, Change change) {
  // Only the link would be replaced, and whoever else reads the file would keep the old key.
  std::error_code ignored;
  if (fs::is_symlink(file, ignored)) {
    return error_of(file, "is a link, and nothing was changed; please name the file itself: " +
                              fs::weakly_canonical(file, ignored).string());
  }
  SecretText old_text;
  struct stat info = {};
  if (const Status read = read_text(file, old_text, info); !read) return read;
  FleetKeys keys;
  if (const Status parsed = parse(file, old_text.view(), keys); !parsed) return parsed;
  if (const Status changed = change(keys); !changed) return changed;
  SecretText text;
  compose(text, keys);
  info.st_mode &= 0640;
  const Status written = write_whole_file(file, text.view(), {.like = &info});
  return written ? written : error_of(file, written.error().message);
}

}  // namespace

Status rotate_fleet_key(const fs::path& file) {
  return change_file(file, [](FleetKeys& keys) {
    keys.previous = keys.current;
    keys.has_previous = true;
    // Hints that differ tell at once which of the two a datagram is sealed with.
    while (key_hint(keys.current) == key_hint(keys.previous)) keys.current = SecretKey::random();
    return Status();
  });
}

Status swap_fleet_keys(const fs::path& file) {
  return change_file(file, [&file](FleetKeys& keys) -> Status {
    if (!keys.has_previous) {
      return error_of(file, "holds one key; `zenith key rotate` puts a new one in front of it");
    }
    std::swap(keys.current, keys.previous);
    return {};
  });
}

}  // namespace zenith
