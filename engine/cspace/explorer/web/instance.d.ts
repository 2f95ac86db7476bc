/* What `mount` hands to the scripts of one explorer. */

declare const root: HTMLElement;
declare const robot: Robot;
declare const options: Options;
