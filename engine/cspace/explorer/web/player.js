/* A fraction that goes from 0 to 1 by itself: how far a path is. */

const PACE = 14; // s for a way as wide as the picture, and
const PAUSE = 1200; // ms at each stop where the reader wants nothing to move

/** Where the reader wants no motion, the fraction goes from stop to stop. `show` hears of it and
    `change` of whether it runs; `speed` is asked at every step.
 * @type {(show: (done: number) => void, change: (runs: boolean) => void, speed?: () => number) => Player} */
function player(show, change, speed = () => 1) {
  const calm = window.matchMedia("(prefers-reduced-motion: reduce)");
  let [done, frame, timer, runs] = [0, 0, 0, false];
  const stop = () => {
    window.cancelAnimationFrame(frame);
    window.clearTimeout(timer);
    if (runs) turn(false);
  };
  /** @type {(on: boolean) => void} */
  const turn = (on) => {
    runs = on;
    change(on);
  };
  /** @type {(value: number) => boolean} */
  const reach = (value) => {
    done = Math.min(1, value);
    show(done);
    return done < 1;
  };
  /** @type {(seconds: number, loops: boolean) => void} */
  const glide = (seconds, loops) => {
    let last = performance.now();
    /** @type {(now: number) => void} */
    const step = (now) => {
      const next = done + (between(now - last, 0, 100) * speed()) / (1000 * seconds);
      last = now;
      if (reach(loops ? next % 1 : next)) frame = window.requestAnimationFrame(step);
      else stop();
    };
    frame = window.requestAnimationFrame(step);
  };
  /** @type {(places: number[]) => void} */
  const leap = (places) => {
    const [next, ...later] = places;
    if (reach(next ?? 1)) timer = window.setTimeout(() => leap(later), PAUSE / speed());
    else stop();
  };
  return {
    calm: () => calm.matches,
    runs: () => runs,
    stop,
    go(value) {
      stop();
      reach(value);
    },
    play({ seconds, places, from = done, loops = false }) {
      stop();
      done = from < 1 ? from : 0;
      turn(true);
      if (calm.matches) leap(places.filter((place) => place > done + 1e-9));
      else glide(seconds, loops);
    },
  };
}
