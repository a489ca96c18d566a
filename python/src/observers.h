#pragma once

#include <pybind11/pybind11.h>

#include "dkp_slam/system/observer.h"

namespace dkp_slam::python {

/// What is called when: None or a callable.
struct Callbacks {
  pybind11::object keyframe, map, loop, merged, lost, found;
};

/// Callables of Python as an observer: called from the observer's thread, with the GIL. What they
/// raise is thrown as `Error`, which the system logs and counts.
class CallableObserver final : public SlamObserver {
 public:
  /// Throws TypeError, which names the argument, for what cannot be called. With the GIL held.
  explicit CallableObserver(const Callbacks& callbacks);
  ~CallableObserver() override;
  CallableObserver(const CallableObserver&) = delete;
  CallableObserver& operator=(const CallableObserver&) = delete;

  bool wants_map() const { return map_ != nullptr; }
  /// Forgets the callables: they may hold the system, which holds this. When no more calls come.
  void let_go();

  void on_keyframe(const KeyframeSnapshot& keyframe) override;
  void on_map(const MapChange& change) override;
  void on_loop(const ClosedLoop& loop) override;
  void on_maps_merged(const ClosedLoop& loop) override;
  void on_lost(const TrackingChange& change) override;
  void on_found(const TrackingChange& change) override;

  /// Whether this thread is in such a call, which must not wait for the system that waits for it.
  static bool calling();

 private:
  PyObject *keyframe_, *map_, *loop_, *merged_, *lost_, *found_;
};

/// As Slam.loops has it.
pybind11::dict loop_dict(const ClosedLoop& loop);

}  // namespace dkp_slam::python
