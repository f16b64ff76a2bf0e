#pragma once
// What goes wrong with robots, done to a drive: set-ups that are wrong, and things that happen on
// the way. Ground truth moves along where time or place changes. Each function changes the tape in
// place; times are seconds from its start.

#include <functional>
#include <string>
#include <vector>

#include "tools/bent/tape.h"

namespace zenith::tools {

enum class WhichWheel { kLeft, kRight, kBoth };

// --- the set-up is wrong ------------------------------------------------------------------------
void mirror_pictures(Tape& tape);  // columns
void turn_mount(Tape& tape, double degrees);
void shift_centre(Tape& tape, double columns_px, double rows_px);
// Focal length of another lens, or of another zoom.
void scale_focal(Tape& tape, double factor);
// Intrinsics of a picture that is so many times as large.
void scale_resolution(Tape& tape, double factor);
void swap_wheels(Tape& tape);
void reverse_wheels(Tape& tape, WhichWheel which);
void scale_wheels(Tape& tape, double factor);
void delay_wheels(Tape& tape, double delay_s);  // their stamps become later

// --- something happens --------------------------------------------------------------------------
// The robot stands while its wheels turn; noisy copies of one picture.
void slip(Tape& tape, double at_s, double duration_s, double left_m, double right_m);
// The wheels tell nothing of what the robot does meanwhile.
void push(Tape& tape, double from_s, double to_s);
// Drives until `lifted_s`, is put down where it is at `down_s`, and goes on.
void carry(Tape& tape, double lifted_s, double down_s);
void drop_frames(Tape& tape, double from_s, double to_s);
void cover_lens(Tape& tape, double from_s, double to_s);
// Something dark over a part of the picture: `share` of its columns.
void cover_side(Tape& tape, double share);
void freeze_picture(Tape& tape, double from_s);
void repeat_frames(Tape& tape);  // each a second time, half a period later
void jitter_stamps(Tape& tape, double sigma_s, std::uint64_t seed);
void blank_pictures(Tape& tape);  // a plain grey ceiling
// Something of the robot in the picture: a dark patterned disc at the edge of what is seen.
void put_robot_in_view(Tape& tape, double radius_px);

struct Bend {
  std::string name;  // with its size: "yaw 10 deg"
  std::function<void(Tape&)> apply;
};

// Every kind at several sizes for a drive of `duration_s`; `quick`: one size of the most telling.
std::vector<Bend> list_bends(double duration_s, bool quick);

}  // namespace zenith::tools
