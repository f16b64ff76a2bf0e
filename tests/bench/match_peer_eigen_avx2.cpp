#ifdef __x86_64__
#define ZENITH_PEER_SET EigenAvx2
#define ZENITH_PEER kEigenAvx2
#define ZENITH_PEER_NAME "eigen-avx2"
#include "tests/bench/match_peer_eigen.h"
#endif
