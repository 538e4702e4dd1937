// Other recordings for the report's player (player.js, whose names these are), which was made with the first of them.
const replay = {
  // Puts another recording in place of the one that is shown.
  take(fresh) {
    if (state.playing) stop();
    for (const key of Object.keys(data)) delete data[key];
    Object.assign(data, fresh);
    motions.splice(0, motions.length, ...data.runs.map((run) => new Motion(run, data.bodies, data.gravity)));
    Object.assign(part("scrubber"), { min: data.begin, max: data.end });
    part("engine").replaceChildren(...data.runs.slice(1).map((run, k) => new Option([run.name, run.verdict].filter(Boolean).join(": "), k + 1)));
    part("choice").hidden = data.runs.length < 3;
    state.time = data.begin;
    choose(data.lead);
    part("engine").value = String(state.chosen);
  },

  // From the start, moving where motion is wanted.
  begin() {
    zoom(false);
    seek(data.begin);
    play();
  },
};
