#ifdef __x86_64__
#define ZENITH_PEER_SET EigenAvx2Update
#define ZENITH_PEER kUpdateAvx2
#define ZENITH_PEER_NAME "eigen-avx2"
#include "tests/bench/update_peer_eigen.h"
#endif
