#include "platform/storage/map_store.h"

#include <algorithm>
#include <utility>

namespace zenith::storage {
namespace {

// Further ones stay where they are, and block their generation.
constexpr int kMostAside = 100;

}  // namespace

LoadedMap MapStore::load(Damaged damaged) {
  LoadedMap loaded;
  for (std::size_t i = 0; i < kGenerations; ++i) {
    const std::string name = file(i);
    if (!folder_.exists(name)) continue;
    const std::string path = folder_.path_of(name);
    DecodedMap decoded;
    const auto bytes = folder_.read(name, kMaxMapBytes);
    if (bytes) {
      decoded = decode_map(*bytes);
      if (decoded.fault != MapFault::kNone) loaded.messages.push_back(path + ": " + decoded.reason);
    } else {
      decoded.fault = MapFault::kDamaged;
      loaded.messages.push_back(bytes.error().message);
    }
    if (decoded.fault != MapFault::kNone && damaged == Damaged::kLeave) {
      unreadable_[i] = decoded.fault;
      continue;
    }
    if (decoded.fault != MapFault::kNone) {
      std::string to;
      const Status moved = set_aside(i, decoded.fault, to);
      loaded.messages.push_back(moved ? "it is set aside as " + to
                                      : "and it stays in its place: " + moved.error().message);
      continue;
    }
    if (loaded.map && loaded.map->head.checkpoint >= decoded.map.head.checkpoint) continue;
    newest_ = i;
    checkpoint_ = decoded.map.head.checkpoint;
    loaded.file = path;
    loaded.map = std::move(decoded.map);
  }
  return loaded;
}

Status MapStore::set_aside(std::size_t generation, MapFault fault, std::string& to) {
  unreadable_[generation] = fault;
  const Status moved =
      rename_aside(generation, fault == MapFault::kForeign ? ".foreign" : ".damaged", to);
  if (moved) unreadable_[generation] = MapFault::kNone;
  return moved;
}

Status MapStore::set_all_aside() {
  for (std::size_t i = 0; i < kGenerations; ++i) {
    std::string to;
    if (!folder_.exists(file(i))) continue;
    if (const Status moved = rename_aside(i, ".left", to); !moved) return moved;
  }
  return {};
}

Status MapStore::remove() {
  for (std::size_t i = 0; i < kGenerations; ++i) {
    if (!folder_.exists(file(i))) continue;
    if (const Status removed = folder_.remove(file(i)); !removed) return removed;
  }
  return folder_.sync_folder();
}

Status MapStore::rename_aside(std::size_t generation, const std::string& kind, std::string& to) {
  const std::string name = file(generation);
  for (int i = 1; i <= kMostAside; ++i) {
    const std::string aside = name + kind + (i == 1 ? "" : "-" + std::to_string(i));
    if (folder_.exists(aside)) continue;
    if (const Status moved = folder_.rename(name, aside); !moved) return moved;
    to = folder_.path_of(aside);
    (void)folder_.sync_folder();  // else it is found and set aside again
    return {};
  }
  return Error{folder_.path_of(name) + ": there are " + std::to_string(kMostAside) +
               " such files set aside already; move them elsewhere"};
}

Status MapStore::save(StoredMap& map) {
  const std::size_t target = 1 - newest_;
  if (unreadable_[target] != MapFault::kNone) {
    std::string to;
    if (const Status moved = set_aside(target, unreadable_[target], to); !moved) return moved;
  }
  map.head.checkpoint = checkpoint_ + 1;
  const std::vector<std::uint8_t> bytes = encode_map(map);
  const Status written = write_partial(bytes);
  folder_.close();
  if (!written) {
    (void)folder_.remove(partial());  // a full disk needs the room
    return written;
  }
  if (const Status put = folder_.rename(partial(), file(target)); !put) {
    (void)folder_.remove(partial());
    return put;
  }
  bytes_written_ += bytes.size();
  // A power cut may still undo the new name. Until the folder is synced the other generation is the
  // one that counts, and the next save() writes over this one once more.
  if (const Status synced = folder_.sync_folder(); !synced) return synced;
  newest_ = target;
  ++checkpoint_;
  return {};
}

Status MapStore::write_partial(Bytes bytes) {
  if (const Status created = folder_.create(partial()); !created) return created;
  // In pieces: no write is so long that a slow card holds everything else up.
  constexpr std::size_t kPiece = std::size_t{64} * 1024;
  while (!bytes.empty()) {
    const Bytes piece = bytes.first(std::min(kPiece, bytes.size()));
    if (const Status written = folder_.write(piece); !written) return written;
    bytes = bytes.subspan(piece.size());
  }
  return folder_.sync();
}

}  // namespace zenith::storage
