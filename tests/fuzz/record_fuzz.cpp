// Any bytes: a record that decodes is finite, is taken by PeerMap, and is encoded the same again.

#include <cstdint>
#include <cstdlib>
#include <memory>

#include "slam/exchange/record_code.h"
#include "slam/fleet/peer_map.h"
#include "tests/fuzz/require.h"
#include "tests/support/arena_block.h"

using namespace zenith;            // NOLINT(google-build-using-namespace)
using namespace zenith::exchange;  // NOLINT(google-build-using-namespace)

namespace {

struct Peer {
  PeerLandmarkPool pool;
  PeerMap map;
  ArenaBlock memory{[this](Arena& arena) {
    pool.layout(arena);
    map.layout(arena, pool);
  }};
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Peer peer;
  ByteReader in(Bytes(data, size));
  LandmarkRecord record;
  if (!decode_record(in, 1, record)) return 0;
  record.id = 1;  // one landmark, so that the map never fills
  require(peer.map.apply(record));

  EncodedRecord encoded;
  require(encode_record(record, encoded));
  ByteReader again(encoded.bytes());
  LandmarkRecord twice;
  require(decode_record(again, record.revision, twice));
  require(again.done());
  require(twice.x_m == record.x_m && twice.y_m == record.y_m && twice.z_m == record.z_m);
  require(twice.covariance_m2[0] == record.covariance_m2[0]);
  require(twice.covariance_m2[3] == record.covariance_m2[3]);
  require(twice.covariance_m2[5] == record.covariance_m2[5]);
  require(twice.appearance_count == record.appearance_count);
  require(twice.observations == record.observations && twice.removed == record.removed);
  return 0;
}
