#!/usr/bin/env python3
"""How a hand moves a camera: amplitude per octave of frequency, of a TUM ground-truth file.

    motion_spectrum.py [--sphere] FILE...

For every file: means, speeds, and a table (rows: octaves from 0.04 Hz; columns: the six degrees of
freedom) of root mean squares. The tables of dkp_slam/synth/path/recorded_motion.cpp are its
output for the benchmark's freiburg3 sequences. Degrees of freedom, in a world with z up:
sideways, ahead and up in metres, or with --sphere azimuth and elevation (radians) and distance
(metres) around the point that the camera looks at; then yaw, pitch and roll of the view, radians
(with --sphere: beside the direction to that point). What motion capture adds by itself (jitter,
taken as white, from 15 to 40 Hz) is subtracted.
"""
import argparse

import numpy as np

BANDS = 0.04 * 2.0 ** np.arange(8)  # edges, Hz
RATE = 100.0


def rotation(q):
    x, y, z, w = (q / np.linalg.norm(q, axis=1, keepdims=True)).T
    return np.stack([
        np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], 1),
        np.stack([2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)], 1),
        np.stack([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], 1)], 1)


def view_angles(r):
    """Azimuth (from +y, towards -x), elevation and roll of the view of cameras (x right, y down)."""
    ahead, right = r[:, :, 2], r[:, :, 0]
    azimuth = np.unwrap(np.arctan2(-ahead[:, 0], ahead[:, 1]))
    elevation = np.arcsin(np.clip(ahead[:, 2], -1, 1))
    level = np.stack([np.cos(azimuth), np.sin(azimuth), 0 * azimuth], 1)
    above = np.cross(level, ahead)
    roll = np.arctan2(np.sum(right * above, 1), np.sum(right * level, 1))
    return azimuth, elevation, roll


def resampled(path):
    rows = np.loadtxt(path)
    t = np.arange(rows[0, 0], rows[-1, 0], 1 / RATE)
    q = rows[:, 4:8].copy()
    for i in range(1, len(q)):
        if q[i] @ q[i - 1] < 0:
            q[i] = -q[i]
    at = lambda columns: np.stack([np.interp(t, rows[:, 0], c) for c in columns.T], 1)
    return t - t[0], at(rows[:, 1:4]), rotation(at(q))


def turned(p, r):
    """The path turned about z, so that its mean view goes along +y."""
    ahead = r[:, :, 2].mean(0)
    a = np.arctan2(ahead[0], ahead[1])
    turn = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    return p @ turn.T, turn @ r


def nearest_to_rays(p, d):
    eye = np.eye(3)
    projections = eye - d[:, :, None] * d[:, None, :]
    return np.linalg.solve(projections.sum(0), (projections @ p[:, :, None]).sum(0)[:, 0])


def band_rms(x):
    x = x - x.mean()
    window = np.ones(len(x))
    edge = len(x) // 20
    window[:edge] = 0.5 - 0.5 * np.cos(np.pi * np.arange(edge) / edge)
    window[-edge:] = window[:edge][::-1]
    power = np.abs(np.fft.rfft(x * window)) ** 2 * 2 / len(x) / np.sum(window**2)
    f = np.fft.rfftfreq(len(x), 1 / RATE)
    floor = np.mean(power[(f > 15) & (f < 40)])
    rms = []
    for low, high in zip(BANDS[:-1], BANDS[1:]):
        inside = (f >= (low if low > BANDS[0] else 1e-9)) & (f < high)
        rms.append(np.sqrt(max(np.sum(power[inside] - floor), 0.0)))
    return rms, np.sqrt(floor * len(f))


def report(path, sphere):
    t, p, r = resampled(path)
    p, r = turned(p, r)
    yaw, pitch, roll = view_angles(r)
    step = int(RATE / 10)  # speeds over a tenth of a second: jitter does not count
    speed = np.linalg.norm(p[step:] - p[:-step], axis=1) * 10
    between = np.einsum('nji,njk->nik', r[:-step], r[step:])
    angle = np.arccos(np.clip((np.trace(between, axis1=1, axis2=2) - 1) / 2, -1, 1)) * 10
    print(f'{path}: {t[-1]:.1f} s')
    print(f'  mean height {p[:, 2].mean():.3f} m, pitch {np.degrees(pitch.mean()):.1f}, '
          f'roll {np.degrees(roll.mean()):.1f} degrees')
    print(f'  speed mean {speed.mean():.3f}, 95% {np.quantile(speed, .95):.3f}, '
          f'max {speed.max():.3f} m/s')
    print(f'  turning mean {np.degrees(angle.mean()):.2f}, 95% '
          f'{np.degrees(np.quantile(angle, .95)):.2f}, max {np.degrees(angle.max()):.2f} deg/s')
    columns = [p[:, 0], p[:, 1], p[:, 2], yaw, pitch, roll]
    if sphere:
        target = nearest_to_rays(p, r[:, :, 2])
        away = p - target
        distance = np.linalg.norm(away, axis=1)
        azimuth = np.unwrap(np.arctan2(away[:, 0], -away[:, 1]))
        elevation = np.arcsin(away[:, 2] / distance)
        columns = [azimuth, elevation, distance, yaw - azimuth, pitch + elevation, roll]
        print(f'  looks at a point {distance.mean():.3f} m away, {target[2]:.3f} m high, from an '
              f'elevation of {np.degrees(elevation.mean()):.1f} degrees')
    print('  range ', ' '.join(f'{np.ptp(c):8.4f}' for c in columns))
    print('  crest ', ' '.join(f'{np.abs(c - c.mean()).max() / c.std():8.2f}' for c in columns))
    found = [band_rms(c) for c in columns]
    print('  jitter', ' '.join(f'{jitter:8.5f}' for _, jitter in found))
    for i, row in enumerate(np.array([rms for rms, _ in found]).T):
        print(f'  {BANDS[i]:5.2f}  {{' + ', '.join(f'{v:.5f}' for v in row) + '},')


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('--sphere', action='store_true', help='motion around a point')
    parser.add_argument('files', nargs='+')
    arguments = parser.parse_args()
    for path in arguments.files:
        report(path, arguments.sphere)


if __name__ == '__main__':
    main()
