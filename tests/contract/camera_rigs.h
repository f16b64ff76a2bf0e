#pragma once
// Every camera with something in front of it, for the contract that all of them keep.

#include <memory>
#include <string>
#include <vector>

#include "drivers/camera/camera.h"

namespace zenith {

class CameraRig {
 public:
  CameraRig() = default;
  CameraRig(const CameraRig&) = delete;
  CameraRig& operator=(const CameraRig&) = delete;
  virtual ~CameraRig() = default;

  // Why the rig cannot be built here; empty when it can. Nothing else is called then.
  virtual std::string missing() const { return ""; }
  // Not open yet.
  virtual Camera& camera() = 0;
  virtual int width_px() const = 0;
  virtual int height_px() const = 0;
  // The clock of stamps and timeouts.
  virtual Time now() const = 0;
  // The open camera takes `count` more frames, or about as many, with nobody waiting for them.
  virtual void let_frames_come(int count) = 0;

  // Puts another picture before a camera whose picture would stay the same.
  virtual void change_picture() {}

  // Cameras that can be held still (no frame and no error), and then take exactly the frames that
  // they are let.
  virtual bool is_exact() const { return false; }
  virtual void hold_still(bool) {}
  // Cameras that can be pulled out.
  virtual bool can_fail() const { return false; }
  virtual void set_plugged(bool) {}
};

struct NamedCameraRig {
  const char* name;
  std::unique_ptr<CameraRig> (*make)();
};

// V4L2 on a kernel in memory, a simulated camera, a replayed one, V4L2 on the device that
// $ZENITH_TEST_VIDEO names (root, for pulling it out), and the camera of libcamera whose name holds
// $ZENITH_TEST_LIBCAMERA.
const std::vector<NamedCameraRig>& camera_rigs();

// A recording that plays again and again; where the build reads recordings
// (ZENITH_WITH_RECORDINGS).
std::unique_ptr<CameraRig> make_replayed_rig();

}  // namespace zenith
