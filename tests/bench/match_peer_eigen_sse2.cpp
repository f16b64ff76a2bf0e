#define ZENITH_PEER_SET EigenSse2
#define ZENITH_PEER kEigenSse2
#define ZENITH_PEER_NAME "eigen-sse2"
#include "tests/bench/match_peer_eigen.h"
