#ifdef __x86_64__
#define ZENITH_PEER_SET EigenAvx512
#define ZENITH_PEER kEigenAvx512
#define ZENITH_PEER_NAME "eigen-avx512"
#include "tests/bench/match_peer_eigen.h"
#endif
