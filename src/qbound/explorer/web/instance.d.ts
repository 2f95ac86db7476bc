/* What a script finds when Python has joined them: the names that `mount` hands to the scripts of
   one explorer, and the markup of parts.html. */

declare const MARKUP: string;
declare const root: HTMLElement;
declare const robot: Robot;
declare const options: Options;
declare function mount(root: HTMLElement, robot: Robot, options?: Options): Explorer;
