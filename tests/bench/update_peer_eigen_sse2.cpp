#define ZENITH_PEER_SET EigenSse2Update
#define ZENITH_PEER kUpdateSse2
#define ZENITH_PEER_NAME "eigen-sse2"
#include "tests/bench/update_peer_eigen.h"
