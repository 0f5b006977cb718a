/** Models beside the first as they are in a recording. */
import { Box3, Group } from "three";
import type { Past } from "../timeline/recording";
import { Body } from "./body";

export class Recorded {
  readonly group = new Group();
  /** By their sessions. */
  private readonly all = new Map<string, Body>();

  /** `isElsewhere`: the model of this session is drawn by another. */
  constructor(private readonly changed: () => void, private readonly isElsewhere: (session: string) => boolean = () => false) {}

  /** As they were at this moment, or none. */
  show(past: Past | null): void {
    for (const { group } of this.all.values()) group.visible = false;
    for (const [session, track] of past?.recording.tracks() ?? []) {
      const stands = past?.scene.beside.find((one) => one.session === session);
      if (!past || !stands || this.isElsewhere(session)) continue;
      const index = track.columns.indexAt(past.time);
      const state = track.stateAt(index);
      if (!state) continue;
      const body = this.all.get(session) ?? this.begin(session);
      body.build(track.sceneAt(index));
      body.stand(stands, stands.transparent);
      body.robot.place(state);
      body.group.visible = true;
    }
  }

  /** With the models in it. */
  within(box: Box3): Box3 {
    for (const { group } of this.all.values()) if (group.visible) box.union(new Box3().setFromObject(group));
    return box;
  }

  private begin(session: string): Body {
    const body = new Body({ changed: this.changed, problems: () => undefined });
    this.all.set(session, body);
    this.group.add(body.group);
    return body;
  }
}
